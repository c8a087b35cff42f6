#!/usr/bin/env python3
"""Checks the order of the layers and that every third-party library is included by one source file. Fatal on a breach.

A file may include headers of its own layer or a lower one. Layers, lowest first: see `layer_of`. Prints one line a breach.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')

# The folders of compiler/ in the order of the data: each may include itself and what stands before it. Files directly in
# compiler/ are the pass.
ORDER = ["base", "runtime", "manifest", "space", "split", "reflect", "toolchain", "modules", "translate", "batch", "interfaces", "table", "pass",
         "bake", "validate", "device", "report"]

# Third-party header prefix -> the files that may include it.
THIRD_PARTY = {
    "xxhash": {"compiler/base/xxh3.cpp"},
    "openssl/": {"compiler/base/sha256.cpp", "cache/client/signature.cpp"},
    # Beast's connection is a template over its stream (TCP, TLS), hence the headers.
    "boost/": {"cache/server/http_server.cpp", "cache/server/http_connection.h", "cache/server/http_head.h", "cache/server/http_loop.h", "cache/server/tls_stream.h"},
    # Services derive from generated classes, a source each; what they share is in the header.
    "grpcpp/": {"cache/server/grpc_call.h", "cache/server/grpc_server.cpp", "cache/client/grpc_calls.h", "tools/bench/batch_read_bench.cpp"},
    "grpc/": {"cache/client/grpc_remote.cpp"},
    "remote_execution": {"cache/server/grpc_call.h", "cache/client/grpc_remote.cpp", "cache/execute/reapi_action.h", "tools/bench/batch_read_bench.cpp"},
    "bytestream": {"cache/server/grpc_stream.cpp", "cache/client/grpc_calls.h"},
    "prometheus/": {"cache/server/metrics_page.cpp"},
    "zstd": {"cache/zstd.cpp"},
    "gmp": {"compiler/space/count.cpp"},
    "yaml-cpp/": {"compiler/manifest/yaml.cpp", "cache/server/config_yaml.cpp"},
    "glslang/": {"compiler/toolchain/glsl.cpp"},
    "spirv-tools/": {"compiler/toolchain/spirv.cpp"},
    "spirv_cross/": {"compiler/toolchain/cross.cpp"},
    "curl/": {"cache/client/http_transfer.cpp"},
    "lmdb": {"cache/disk_index.cpp"},
    "lz4": {"compiler/table/table_text.cpp"},
    "png": {"compiler/device/png.cpp"},
}

def folder_of(path):
    """Index into ORDER of a file of compiler/."""
    parts = path.parts
    return ORDER.index(parts[1]) if len(parts) > 2 else ORDER.index("pass")


def layer_of(path):
    """0 base and runtime, 1 cache, 2 stages, 3 pass, 4 validation and device, 5 command line, 6 tests and benchmarks."""
    parts = path.parts
    if parts[0] == "tests" or parts[:2] == ("tools", "bench"):
        return 6
    if parts[0] == "tools":
        return 5
    if parts[0] == "cache":
        return 1
    if parts[0] != "compiler":
        return None
    index = folder_of(path)
    return 0 if index < ORDER.index("manifest") else 2 if index < ORDER.index("pass") else 3 if index == ORDER.index("pass") else 4


def check(path, breaches):
    relative = path.relative_to(ROOT)
    layer = layer_of(relative)
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        bracket, header = match.groups()
        where = f"{relative}:{number}"
        if bracket == '"':
            target = pathlib.Path(header)
            if not (ROOT / target).exists() and not (path.parent / target).exists():
                continue
            if not (ROOT / target).exists():
                target = (path.parent / target).resolve().relative_to(ROOT)
            below = layer_of(target)
            if layer is None or below is None:
                continue
            if relative.parts[0] == target.parts[0] == "compiler" and folder_of(target) > folder_of(relative):
                breaches.append(f"{where}: {ORDER[folder_of(relative)]} includes {header}, which comes later")
            elif below > layer:
                breaches.append(f"{where}: layer {layer} includes {header} of layer {below}")
            if relative.parts[0] == "cache" and target.parts[0] == "compiler" and target.parts[1] != "base":
                breaches.append(f"{where}: cache/ may use compiler/base only, not {header}")
            if relative.parts[0] == "compiler" and target.parts[0] == "cache":
                breaches.append(f"{where}: compiler/ must not know cache/")
            if relative.parts[:2] == ("compiler", "runtime") and target.parts[:2] != ("compiler", "runtime"):
                breaches.append(f"{where}: compiler/runtime depends on nothing but the standard library")
            continue
        if layer in (5, 6) and relative.parts[0] == "tests":
            continue
        if header.startswith("vulkan/"):
            if relative.parts[:2] != ("compiler", "device"):
                breaches.append(f"{where}: vulkan.h belongs to compiler/device")
            continue
        for prefix, owners in THIRD_PARTY.items():
            if header.startswith(prefix):
                if str(relative) not in owners:
                    breaches.append(f"{where}: <{header}> may be included by {', '.join(sorted(owners))} only")
                break
        else:
            if relative.parts[:2] == ("compiler", "runtime") and ("/" in header):
                breaches.append(f"{where}: compiler/runtime includes <{header}>")
            elif "/" in header and not header.startswith(("sys/", "arpa/")):
                if relative.parts[0] == "tools" and header.startswith("benchmark/"):
                    continue
                breaches.append(f"{where}: third-party header <{header}> has no owner in tools/layers.py")


def main():
    breaches = []
    for folder in ("compiler", "cache", "tools", "tests"):
        for path in sorted((ROOT / folder).rglob("*")):
            if "node_modules" in path.parts:
                continue
            if path.relative_to(ROOT).parts[:2] == ("tools", "examples"):
                continue  # projects outside, which see what is installed
            if path.suffix in (".h", ".hpp", ".cpp", ".c"):
                check(path, breaches)
    for entry in sorted(ROOT.iterdir()):
        allowed = {"CMakeLists.txt", "CMakePresets.json", "README.md", "ARCHITECTURE.md", "LICENSE", "CONTRIBUTING.md", "CHANGELOG.md",
                   "SECURITY.md", "compiler", "uber", "manifests", "cache", "tests", "tools", "build", "demo-out"}
        if not entry.name.startswith(".") and entry.name not in allowed and not entry.name.startswith("build-"):
            breaches.append(f"{entry.name}: not a top-level entry of the layout")
    for breach in breaches:
        print(breach)
    if not breaches:
        print("layers: ok")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
