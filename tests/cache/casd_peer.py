#!/usr/bin/env python3
"""kiln build --cache grpc:// against buildbox-casd, a server that is not ours (API 2.1 and newer): cold, all hits, hits by pieces, its
end in the middle of a build. casd_peer.py needs tools/peers.sh; without a newer suite it is skipped."""
import importlib.util
import pathlib
import shutil
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "server"))
spec = importlib.util.spec_from_file_location("suite", HERE.parent / "server" / "peers.py")  # this folder has a peers.py as well
suite = importlib.util.module_from_spec(spec)
spec.loader.exec_module(suite)
sys.path.insert(0, str(HERE))
from peers import KILN, build, check, environment, in_folder, same


def main():
    home = pathlib.Path.cwd()
    port = suite.free_port()
    url = f"grpc://127.0.0.1:{port}"
    words = programs.tool("buildbox-casd", f"--bind=127.0.0.1:{port}", "--quota-high=1G", "--reserved=1M", home / "casd")

    def remote(table, manifest="p/m.yaml", **env):
        return build(manifest, table, "--cache", "none", "--cache", url, **env)

    build("p/m.yaml", "alone.kiln", "--cache", "none")
    with suite.Daemon(words, home, port) as casd:
        one = remote("one.kiln")
        same("alone.kiln", "one.kiln", "the first build")
        check(one.remote["hits"] == 0 and one.json["work"]["compiled"] > 0, f"found something in an empty casd: {one.remote}")
        check(one.remote["sent"] > 10 and one.remote["not_sent"] == 0 and one.remote["failures"] == 0, f"not sent: {one.remote} {one.err}")
        two = remote("two.kiln")
        same("alone.kiln", "two.kiln", "the second build")
        check(two.json["work"]["compiled"] == 0 and two.remote["hits"] == 3 and two.remote["misses"] == 0, f"no pure hits: {two.remote}")
        check(one.err == "" and two.err == "", f"said: {one.err}{two.err}")
        shutil.copytree("p", "q")
        source = pathlib.Path("q/paint.frag")
        source.write_text(source.read_text() + "// a remark\n")
        three = remote("three.kiln", "q/m.yaml")
        check(three.json["work"]["compiled"] == 0 and three.json["work"]["preprocessed"] > 0 and three.remote["hits"] > 10, f"by pieces: {three.remote}")

        # Bytes that casd's own disk changed: it gives them as they are or not at all, and the table stays.
        hurt = 0
        for path in (home / "casd").rglob("*"):
            if path.is_file() and not path.is_symlink() and "objects" in path.parts and path.stat().st_size > 500:
                data = path.read_bytes()
                path.chmod(0o644)
                path.write_bytes(data[:100] + bytes([data[100] ^ 1]) + data[101:])
                hurt += 1
        check(hurt > 0, "nothing of casd's was found to damage")
        four = remote("four.kiln")
        same("alone.kiln", "four.kiln", "damaged blobs")
        check(four.json["work"]["compiled"] > 0 and four.err.count("warning") == 1, f"damaged blobs: {four.remote} {four.err}")

        shutil.copytree(HERE.parents[1] / "uber", "uber")
        shutil.copytree(HERE.parents[1] / "manifests", "manifests")
        build("manifests/surface.yaml", "whole.kiln", "--cache", "none")
        process = subprocess.Popen([KILN, "build", "manifests/surface.yaml", "-o", "torn.kiln", "--cache", "none", "--cache", url],
                                   env=environment(KILN_CACHE_TIMEOUT="1"), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        time.sleep(1)
        casd.end()
        err = process.communicate(timeout=120)[1]
        check(process.returncode == 0 and err.count("warning") <= 1, f"casd was ended: {err}")
        same("whole.kiln", "torn.kiln", "casd was ended")


programs = suite.Peers()
in_folder(main)
print("casd: ok")
