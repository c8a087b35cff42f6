#!/usr/bin/env python3
"""The man page and the systemd unit against the server that they describe. usage: packaging_test.py KILN_CACHED [TEST...]"""
import pathlib
import re
import shutil
import subprocess
import tempfile

from cached import SKIP, Cached, check, equal, key, main

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent / "tools" / "packaging"
skipped = []


def man_page(binary):
    """Every option of --help is in it and no other; it formats without a warning."""
    words = lambda text: set(re.findall(r"--[a-z_][a-z_.]*", text))
    help_ = subprocess.run([binary, "--help"], stdout=subprocess.PIPE, check=True).stdout.decode()
    source = (ROOT / "kiln-cached.8").read_text().replace("\\-", "-")
    mine = words(source) - {"--remote_cache"}
    equal(mine - words(help_), {"--config"} - words(help_), "options that --help does not know")
    equal(words(help_) - mine, set(), "options that the page does not know")
    check(len(mine) > 20, f"positive control: {mine}")
    if shutil.which("groff") is None:
        skipped.append("man_page: groff is not installed, warnings are not looked for")
        return
    done = subprocess.run(["groff", "-man", "-ww", "-Tutf8", str(ROOT / "kiln-cached.8")], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    equal((done.returncode, done.stderr.decode()), (0, ""), "groff")
    check("SIGHUP" in re.sub("\x1b\\[[0-9;]*m|.\b", "", done.stdout.decode()), "the page as text")


def unit(binary):
    """systemd takes every line; what it starts is what the server understands."""
    text = (ROOT / "kiln-cached.service").read_text()
    if shutil.which("systemd-analyze") is None:
        skipped.append("unit: systemd-analyze is not installed")
        return
    with tempfile.TemporaryDirectory() as home:
        path = pathlib.Path(home) / "kiln-cached.service"
        path.write_text(text.replace("/usr/bin/kiln-cached", binary))
        done = subprocess.run(["systemd-analyze", "verify", "--man=no", "--recursive-errors=no", str(path)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        said = [line for line in done.stdout.decode().splitlines() if "kiln-cached" in line]
        equal((done.returncode, said), (0, []), "systemd-analyze verify")
        path.write_text(text.replace("/usr/bin/kiln-cached", binary).replace("Type=exec", "Type=sometimes"))
        done = subprocess.run(["systemd-analyze", "verify", "--man=no", "--recursive-errors=no", str(path)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        check(b"sometimes" in done.stdout, "positive control: a wrong line is not found")
        config = pathlib.Path(home) / "config.yaml"
        config.write_text(f"folder: {home}/store\nlisten: 127.0.0.1:0\n")
        for line in re.findall(r"^ExecStartPre=(.*)$", text, re.M):
            words = [binary if w.endswith("/kiln-cached") else w.replace("/etc/kiln-cached/config.yaml", str(config)) for w in line.split()]
            equal(subprocess.run(words).returncode, 0, line)


def restricted(binary):
    """The server does its work with no capability, no new privilege, where setpriv is there."""
    if shutil.which("setpriv") is None:
        skipped.append("restricted: setpriv is not installed")
        return
    wrapper = tempfile.NamedTemporaryFile("w", suffix=".sh", delete=False)
    wrapper.write(f'#!/bin/sh\nexec setpriv --no-new-privs --bounding-set=-all --inh-caps=-all "{binary}" "$@"\n')
    wrapper.close()
    pathlib.Path(wrapper.name).chmod(0o755)
    try:
        with Cached(wrapper.name) as server:
            equal(server.put(b"restricted"), 201, "PUT")
            equal(server.get(b"restricted").body, b"restricted", "GET")
    finally:
        pathlib.Path(wrapper.name).unlink()


if __name__ == "__main__":
    try:
        main([man_page, unit, restricted])
    except SystemExit as end:
        for reason in skipped:
            print("SKIP: " + reason)
        raise SystemExit(SKIP if skipped and end.code == 0 else end.code)
