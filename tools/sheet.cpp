// kiln sheet: a picture of some variants, drawn from the table on the device.
#include "compiler/device/sheet.h"

#include "compiler/device/vulkan_device.h"
#include "tools/console.h"
#include "tools/session.h"
#include "tools/table_file.h"
#include "tools/verbs.h"

namespace kiln {

namespace {

Result<Sheet> draw(const Args& args, Session& session) {
    SheetOptions options;
    options.shader = args.value("--shader");
    const auto count = args.number("--count", options.count, 1, 1024);
    KILN_TRY(count);
    const auto tile = args.number("--tile", options.tile, 16, 1024);
    KILN_TRY(tile);
    options.count = static_cast<uint32_t>(*count);
    options.tile = static_cast<uint32_t>(*tile);
    std::string words;
    for (size_t i = 1; i < args.words().size(); ++i) words += (i == 1 ? "" : " ") + args.words()[i];
    if (!words.empty()) options.variants.push_back(words);
    const auto table = open_table(session.files, args.words().front());
    KILN_TRY(table);
    DriverChoice choice;
    choice.icd = args.value("--icd");
    auto device = open_vulkan_device(choice);
    KILN_TRY(device);
    return render_sheet((*table)->bytes(), options, **device, *session.tools);
}

int run_sheet(const Args& args) {
    if (!args.has("--output")) return print_error({Fault::usage, "kiln sheet: where to? give -o FILE.png"});
    auto session = Session::open(args);
    if (!session.ok()) return print_error(session.error());
    const auto sheet = draw(args, **session);
    if (!sheet.ok()) return print_error(sheet.error());
    const std::string path = args.value("--output");
    Status status = (*session)->files.write(path, sheet->png);
    if (status.ok()) status = (*session)->files.write(path + ".txt", as_bytes(sheet->summary));
    if (!status.ok()) return print_error(status.error());
    return finish(path + ": " + std::to_string(sheet->tiles) + " variants, " + std::to_string(sheet->undrawn) +
                      " drew no pixel, " + std::to_string(sheet->failed) + " failed\n",
                  sheet->failed == 0 ? 0 : static_cast<int>(Fault::mismatch));
}

}  // namespace

const Verb verb_sheet{"sheet",
                      "T.kiln -o F.png [--shader S] [--count N] [axis=value …]",
                      "draw a lit sphere on a plane with some of a table's variants, as one picture with labels",
                      1,
                      std::string::npos,
                      {{"--output", "-o", "FILE", "the PNG; FILE.txt beside it says what was drawn"},
                       option_shader,
                       {"--count", nullptr, "N", "how many variants when none are named; default 48"},
                       {"--tile", nullptr, "PIXELS", "side of one variant's picture; default 192"},
                       {"--icd", nullptr, "FILE", "Vulkan driver manifest; default $KILN_ICD, else lavapipe"},
                       option_cache},
                      "kiln sheet surface.kiln -o surface.png",
                      run_sheet};

}  // namespace kiln
