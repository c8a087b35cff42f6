#!/usr/bin/env python3
"""kiln build against nginx: a second machine compiles nothing, in the three ways a build can be partly known; read-only; no
local store; a server whose files were damaged; one that is killed half-way."""
import pathlib
import shutil
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from peers import Nginx, Run, build, check, environment, in_folder, same, KILN

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main():
    nginx = Nginx("nginx")
    try:
        tests(nginx)
    finally:
        nginx.stop()


def tests(nginx):
    alone = build("p/m.yaml", "alone.kiln", "--cache", "none")
    check(alone.remote is None, "a server where none was named")

    one = build("p/m.yaml", "one.kiln", "--cache", "c1", "--cache", nginx.url)
    same("alone.kiln", "one.kiln", "the first build")
    check(one.json["work"]["compiled"] > 0 and one.remote["hits"] == 0, f"the first build found something: {one.remote}")
    check(one.remote["sent"] > 10 and one.remote["not_sent"] == 0 and one.remote["failures"] == 0, f"not sent: {one.remote}")
    check(one.err == "", f"the first build said: {one.err}")

    # A second machine: the whole build is one answer.
    two = build("p/m.yaml", "two.kiln", "--cache", "c2", "--cache", nginx.url)
    same("alone.kiln", "two.kiln", "the second build")
    check(two.json["work"]["compiled"] == 0 and two.json["work"]["translated"] == 0, "the second build compiled")
    check(two.remote["hits"] == 3 and two.remote["misses"] == 0 and two.remote["sent"] == 0, f"no pure hits: {two.remote}")
    # What it found is its own now: the server is not needed.
    local = build("p/m.yaml", "two.kiln", "--cache", "c2")
    check(local.json["work"]["compiled"] == 0, "remote hits were not kept")

    # Without a folder of its own.
    four = build("p/m.yaml", "four.kiln", "--cache", "none", "--cache", nginx.url)
    same("alone.kiln", "four.kiln", "without a local store")
    check(four.json["work"]["compiled"] == 0 and four.remote["hits"] == 3, "no hits without a local store")

    # Other files, equal tokens: neither the build's memo nor the classes' holds, the modules and texts are found in batches.
    shutil.copytree("p", "q")
    source = pathlib.Path("q/paint.frag")
    source.write_text(source.read_text() + "// a remark\n")
    build("q/m.yaml", "alone_q.kiln", "--cache", "none")
    three = build("q/m.yaml", "three.kiln", "--cache", "c3", "--cache", nginx.url)
    same("alone_q.kiln", "three.kiln", "a build with a remark")
    work = three.json["work"]
    check(work["compiled"] == 0 and work["translated"] == 0 and work["preprocessed"] > 0, f"equal tokens compiled: {work}")
    check(three.remote["hits"] > 10, f"hits {three.remote}")

    # Read-only, by flag and by environment: nothing is sent. The control is that there was something to send.
    source.write_text(source.read_text().replace("vec3(0.5)", "vec3(0.25)"))
    for words, env in ((("--cache-read-only",), {}), ((), {"KILN_CACHE_READ_ONLY": "1"})):
        before = len(nginx.requests())
        five = build("q/m.yaml", "five.kiln", "--cache", "none", "--cache", nginx.url, *words, **env)
        asked = nginx.requests()[before:]
        check(five.json["work"]["compiled"] > 0 and five.remote["sent"] == 0, "something was sent or nothing made")
        check(asked and all(method == "GET" for method, _, _ in asked), f"read-only asked {asked}")
    # The address from the environment, with a folder beside it.
    five = Run("build", "q/m.yaml", "-o", "five.kiln", "--json", KILN_CACHE=f"c5,{nginx.url}")
    check(five.remote["sent"] > 0 and pathlib.Path("c5/action").is_dir(), "KILN_CACHE was not followed")

    # Only names that are digests were asked for.
    for method, path, _ in nginx.requests():
        parts = path.strip("/").split("/")
        check(method in ("GET", "HEAD", "PUT") and parts[0] in ("ac", "cas") and len(parts) == 2 and len(parts[1]) == 64, f"asked {method} {path}")
    # Every blob on the server has its content's name.
    for path in (nginx.folder / "data/cas").iterdir():
        digest = subprocess.run(["sha256sum", path], capture_output=True, text=True, check=True).stdout.split()[0]
        check(digest == path.name, f"{path} holds other bytes")

    # Every file on the server damaged, one way after another. The table stays; the control is the honest server above.
    damage = {
        "cut": lambda b: b[: len(b) // 2],
        "empty": lambda b: b"",
        "flipped": lambda b: b[:-3] + bytes([b[-3] ^ 16]) + b[-2:],
        "longer": lambda b: b + b"x",
        "html": lambda b: b"<html><body>Hello</body></html>",
    }
    files = {p: p.read_bytes() for p in (nginx.folder / "data").rglob("*") if p.is_file()}
    for name, change in damage.items():
        for path, good in files.items():
            path.write_bytes(change(good))
        hurt = build("p/m.yaml", "hurt.kiln", "--cache", "none", "--cache", nginx.url)
        same("alone.kiln", "hurt.kiln", f"files that are {name}")
        check(hurt.json["work"]["compiled"] > 0, f"{name}: compiled nothing")
        check(hurt.remote["corrupt"] + hurt.remote["failures"] > 0, f"{name}: nobody noticed: {hurt.remote}")
        check(hurt.err.count("warning") == 1, f"{name}: not one warning: {hurt.err}")
        for path, good in files.items():
            path.write_bytes(good)
    calm = build("p/m.yaml", "calm.kiln", "--cache", "none", "--cache", nginx.url)
    check(calm.remote["hits"] == 3 and calm.err == "", f"the restored server is not as it was: {calm.remote} {calm.err}")

    # A server that keeps what it is given to itself refuses nothing: blobs gone, records there.
    for path in (nginx.folder / "data/cas").iterdir():
        path.unlink()
    gone = build("p/m.yaml", "gone.kiln", "--cache", "none", "--cache", nginx.url)
    same("alone.kiln", "gone.kiln", "records without blobs")
    check(gone.json["work"]["compiled"] > 0 and gone.remote["sent"] > 0, "lost blobs were not sent again")
    healed = build("p/m.yaml", "gone.kiln", "--cache", "none", "--cache", nginx.url)
    check(healed.json["work"]["compiled"] == 0, "the server did not heal")

    killed(nginx)


def killed(nginx):
    """A build of 200 classes whose server dies at some moment of it: asking, compiling, sending."""
    shutil.copytree(ROOT / "uber", "uber")
    shutil.copytree(ROOT / "manifests", "manifests")
    build("manifests/sky_light.yaml", "calm.kiln", "--cache", "none")
    build("manifests/sky_light.yaml", "calm2.kiln", "--cache", "none", "--cache", nginx.url)
    for i, delay in enumerate((0.02, 0.1, 0.3, 0.6)):
        server = Nginx(f"dying{i}")
        # Half of what it could know.
        shutil.copytree(nginx.folder / "data", server.folder / "data", dirs_exist_ok=True)
        for n, path in enumerate(sorted((server.folder / "data").rglob("*"))):
            if path.is_file() and n % 2 == 0:
                path.unlink()
        process = subprocess.Popen([KILN, "build", "manifests/sky_light.yaml", "-o", "torn.kiln", "--cache", "none", "--cache", server.url],
                                   env=environment(KILN_CACHE_TIMEOUT="1"), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        time.sleep(delay)
        server.stop()
        err = process.communicate(timeout=120)[1]
        check(process.returncode == 0, f"the build failed with its server: {err}")
        same("calm.kiln", "torn.kiln", f"a server killed after {delay} s")
        check(err.count("warning") <= 1, f"more than one warning: {err}")


in_folder(main)
print("nginx: ok")
