// Compresses one image to BC1, BC7 or BC6H (unsigned) blocks with Basis Universal, whose Node build the package
// ktx2-encoder carries. The only file that sees that library; bc_encoder.cpp runs it.
//
//   node encode_bc.mjs FORMAT WIDTH HEIGHT IN OUT     FORMAT: bc1, bc7, bc6h
//
// IN: RGBA floats, row after row, little-endian; WIDTH and HEIGHT multiples of 4; for bc1 and bc7 in [0, 1], for bc6h in
// [0, 65504]. OUT: blocks, row after row, 8 bytes each for bc1 and 16 for the others. Exit 1 and a line on standard error
// when that cannot be.
import fs from "node:fs";
import basis from "./node_modules/ktx2-encoder/dist/basis/basis_encoder.js";

const [format, widthText, heightText, input, output] = process.argv.slice(2);
const width = Number(widthText), height = Number(heightText);

function fail(why) {
  fs.writeSync(2, `encode_bc: ${why}\n`);
  process.exit(1);
}

if (!["bc1", "bc7", "bc6h"].includes(format)) fail(`unknown format '${format}'`);
if (!(width > 0 && height > 0 && width % 4 === 0 && height % 4 === 0)) fail(`size ${widthText} x ${heightText}`);
const bytes = fs.readFileSync(input);
if (bytes.length !== width * height * 16) fail(`${bytes.length} bytes for ${width} x ${height}`);

console.log = () => {};  // the library reports progress on standard output
const library = await basis();
library.initializeBasis();
const encoder = new library.BasisEncoder();
encoder.controlThreading(false, 1);
const room = new Uint8Array(width * height * 2 + 65536);
let blocks;

if (format === "bc6h") {
  const rgba_float = 1;  // basisu::hdr_image_type::cHITRGBAFloat
  encoder.setCreateKTX2File(true);
  encoder.setKTX2UASTCSupercompression(false);
  encoder.setFormatMode(library.basis_tex_format.cUASTC_HDR_4x4.value);
  encoder.setUASTCHDRQualityLevel(4);
  encoder.setMipGen(false);
  if (!encoder.setSliceSourceImageHDR(0, new Uint8Array(bytes), width, height, rgba_float, false, 1.0)) fail("image refused");
  const size = encoder.encode(room);
  if (size === 0) fail("not encoded");
  const file = new library.KTX2File(room.slice(0, size));
  const wanted = library.transcoder_texture_format.cTFBC6H.value;
  if (!file.isValid() || !file.startTranscoding()) fail("not transcoded");
  blocks = new Uint8Array(file.getImageTranscodedSizeInBytes(0, 0, 0, wanted));
  if (!file.transcodeImage(blocks, 0, 0, 0, wanted, 0, -1, -1)) fail("not transcoded");
} else {
  const floats = new Float32Array(bytes.buffer, bytes.byteOffset, width * height * 4);
  const rgba8 = Uint8Array.from(floats, (x) => Math.floor(x * 255 + 0.5));
  encoder.setPerceptual(false);
  encoder.setMipGen(false);
  encoder.setKTX2AndBasisSRGBTransferFunc(false);
  encoder.setDDSFormat(format);
  encoder.setDDSBC7Encoder(library.dds_bc7_encoder.cDDSBC7Encoder_BC7E_Scalar);
  if (!encoder.setSliceSourceImage(0, rgba8, width, height, 0)) fail("image refused");
  const size = encoder.encodeToDDS(room);
  if (size === 0) fail("not encoded");
  const expected = (width / 4) * (height / 4) * (format === "bc1" ? 8 : 16);
  if (size < expected) fail("short output");
  blocks = room.slice(size - expected, size);  // a DDS file is its header and the blocks
}
encoder.delete();
fs.writeFileSync(output, blocks);
