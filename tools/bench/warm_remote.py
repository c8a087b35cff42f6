#!/usr/bin/env python3
"""warm_remote.py BUILD [--rounds N] [--manifest M]: what a machine with an empty local store gains from a kiln-cached that knows the
build, over HTTP and gRPC on loopback. Every round measures all of them in turn; printed are medians as shares of the cold build's
time. Aim: the warm build at most 10 %. Nothing is deleted before the end: for minutes after many files were, ext4 looks half a millisecond
and more for the inode of a new one, which is several times what else an entry that is kept locally costs.

  cold        empty local store, no server
  first       empty local store, empty server: what storing and sending adds
  warm        empty local store, the server knows the whole build
  remark      empty local store; a remark was added to every shader, so that only classes' modules and texts are known
  local       the local store knows the whole build
"""
import argparse
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "server"))
from cached import Cached

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROTOCOLS = ("http", "grpc")


class Server(Cached):
    def __init__(self, binary):
        super().__init__(binary, grpc="127.0.0.1:0")
        port = int(self.process.stdout.readline().decode().rsplit(":", 1)[1])
        self.urls = {"http": self.url, "grpc": f"grpc://127.0.0.1:{port}"}


def kiln(binary, manifest, table, folder, url=None):
    words = [binary, "build", manifest, "-o", table, "--cache", folder, *(["--cache", url] if url else [])]
    env = {k: v for k, v in os.environ.items() if not k.startswith("KILN_")}
    began = time.monotonic()
    done = subprocess.run(list(map(str, words)), env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    took = time.monotonic() - began
    if done.returncode != 0 or "warning" in done.stderr:
        sys.exit(f"{words}\n{done.stdout}{done.stderr}")
    return took, done.stdout


def one_round(args, binaries, home, times, number):
    def take(name, manifest, table, folder, *url):
        words = (manifest, table, folder.with_name(f"{folder.name}-{number}"), *url)
        took, said = kiln(binaries / "kiln", *words)
        times.setdefault(name, []).append(took)
        return said

    manifest = home / "manifests" / args.manifest
    table = home / "table.kiln"
    take("cold", manifest, table, home / "cold-first")
    whole = table.read_bytes()
    take("cold", manifest, table, home / "cold")  # the lesser of two is what the others are held against
    times["cold"][-2:] = [min(times["cold"][-2:])]
    take("local", manifest, table, home / "cold")
    for protocol in PROTOCOLS:
        with Server(str(binaries / "kiln-cached")) as server:
            url = server.urls[protocol]
            take(f"first {protocol}", manifest, table, home / f"first-{protocol}", url)
            said = take(f"warm {protocol}", manifest, table, home / f"warm-{protocol}", url)
            if table.read_bytes() != whole or "compiled 0," not in said:
                sys.exit(f"the warm build is no warm build:\n{said}")
            changed = home / "remark" / "manifests" / args.manifest
            said = take(f"remark {protocol}", changed, table, home / f"remark-{protocol}", url)
            if "compiled 0," not in said or "translated 0," not in said:
                sys.exit(f"a remark was compiled:\n{said}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--manifest", default="surface.yaml")
    args = parser.parse_args()
    home = pathlib.Path(tempfile.mkdtemp(prefix="kiln-warm-"))
    times = {}
    try:
        for place in (home, home / "remark"):
            for folder in ("uber", "manifests"):
                shutil.copytree(ROOT / folder, place / folder)
        for shader in (home / "remark" / "uber").rglob("*"):
            if shader.is_file() and shader.suffix in (".vert", ".frag", ".comp", ".glsl"):
                shader.write_text(shader.read_text() + "// a remark\n")
        for number in range(args.rounds):
            one_round(args, args.build / "bin", home, times, number)
    finally:
        shutil.rmtree(home, ignore_errors=True)
    cold = statistics.median(times["cold"])
    print(f"{args.manifest}, {args.rounds} rounds; cold {cold:.2f} s ({min(times['cold']):.2f} to {max(times['cold']):.2f})")
    for name, taken in times.items():
        ratios = sorted(t / c for t, c in zip(taken, times["cold"]))
        print(f"  {name:12} {statistics.median(ratios):6.3f} of cold ({ratios[0]:.3f} to {ratios[-1]:.3f})")
    missed = [p for p in PROTOCOLS if statistics.median(t / c for t, c in zip(times[f"warm {p}"], times["cold"])) > 0.10]
    print("aim, warm <= 0.10 of cold: " + ("missed by " + ", ".join(missed) if missed else "met"))


main()
