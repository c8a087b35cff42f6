#!/usr/bin/env python3
"""README's "A cache server for your CI", followed to the letter but for ports that are free here and a loopback address; then the same job
on another machine with the branches' token, which compiles nothing."""
import json
import os
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from peers import KILN, check, environment, free_port, in_folder, same

ROOT = HERE.parents[1]


def main():
    section = (ROOT / "README.md").read_text().split("## A cache server for your CI")[1].split("\n## ")[0]
    lines = [line[4:] for line in section.splitlines() if line.startswith("    ")]
    script = "\n".join(lines)
    for old, new in (("0.0.0.0", "127.0.0.1"), ("8443", str(free_port())), ("8980", str(free_port()))):
        check(old in script, f"README no longer says {old}")
        script = script.replace(old, new)
    server, job = script.split("# a job:")
    job = "# a job:" + job
    # What a reader does between the lines: waits for the server, and goes to other machines.
    url = job.split("KILN_CACHE=")[1].split()[0].rsplit("/", 1)[0]
    script = f"""{server}
server=$!
trap 'kill $server; wait $server || true' EXIT
until curl -so /dev/null --cacert cert.pem {url}/healthz; do kill -0 $server; sleep 0.05; done
kiln() {{ command kiln "$@" --json >$machine.json; for f in "" .proof; do cp surface.kiln$f $machine.kiln$f; done; rm -rf no-home-cache; }}
machine=main
{job}
machine=branch
{job.replace("main.token", "branch.token")}
"""
    for part in ("uber", "manifests"):
        shutil.copytree(ROOT / part, part)
    os.mkdir("bin")
    for name, path in (("kiln", KILN), ("kiln-cached", os.environ["KILN_CACHED"])):
        os.symlink(path, f"bin/{name}")
    env = environment(PATH=f"{os.getcwd()}/bin:{os.environ['PATH']}")
    done = subprocess.run(["bash", "-euc", script], env=env, capture_output=True, text=True, timeout=280)
    check(done.returncode == 0, f"{script}\n{done.stdout}\n{done.stderr}")
    first, second = (json.loads(pathlib.Path(f"{who}.json").read_text()) for who in ("main", "branch"))
    check(first["remote"]["sent"] > 10 and first["remote"]["failures"] == 0, f"main wrote nothing: {first['remote']}")
    check(first["remote"]["not_sent"] == 0, f"main did not send all: {first['remote']}")
    check(second["work"]["compiled"] == 0 and second["remote"]["misses"] == 0, f"the branch found nothing: {second['remote']}")
    same("main.kiln", "branch.kiln", "README")


in_folder(main)
print("readme: ok")
