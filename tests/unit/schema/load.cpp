// Exits 0 when the compiler reads a manifest or a scene without an error, 1 when it refuses it. For schema_test.py.
#include <cstdio>
#include <string>

#include "compiler/manifest/manifest.h"
#include "compiler/space/scene.h"

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    kiln::DiskFiles files;
    kiln::Diags as_manifest, as_scene;
    if (kiln::load_manifest(files, argv[1], as_manifest) || kiln::load_scene(files, argv[1], as_scene)) return 0;
    for (const kiln::Diag& d : as_manifest.list()) std::fputs(kiln::render(d, false).c_str(), stderr);
    return 1;
}
