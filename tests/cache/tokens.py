#!/usr/bin/env python3
"""kiln build against kiln-cached: roles, tokens from files and the environment, TLS with a CA of its own, records that another wrote
first, seeded mishaps on both sides of the wire."""
import os
import pathlib
import shutil
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "server")]
from cached import Cached
from peers import KILN, Run, build, check, in_folder, same

ROOT = HERE.parents[1]
CACHED = os.environ["KILN_CACHED"]
WRITER, READER, STRANGER = "writer-token-0123456789", "reader-token-0123456789", "stranger-token-0123456789"
TOKENS = [f"ci {WRITER} main:read,cas-write,ac-write pr/*:read,cas-write,ac-write", f"desk {READER} main:read"]
INSTANCES = ["name: main", "name: pr/*, parent: main"]


def own_file(name, text, mode=0o600):
    path = pathlib.Path(name)
    path.touch(mode=0o600)
    path.write_text(text)
    path.chmod(mode)
    return path.absolute()


def main():
    build("p/m.yaml", "alone.kiln", "--cache", "none")
    writer, reader = own_file("writer", WRITER + "\n"), own_file("reader", READER)
    with Cached(CACHED, instances=INSTANCES, tokens=TOKENS, log="requests") as server:
        roles(server, writer, reader)
        conflicts(server, writer)
        mishaps(server, writer)
        log = server.log()
        for token in (WRITER, READER, STRANGER):
            check(token not in log, "a token is in the server's log")
    encrypted(writer)


def roles(server, writer, reader):
    main_url = server.url + "/main"
    # Nothing without a token, nothing with a wrong one, one warning, the same table.
    for env in ({}, {"KILN_CACHE_TOKEN": STRANGER}):
        nobody = build("p/m.yaml", "t.kiln", "--cache", "none", "--cache", main_url, **env)
        same("alone.kiln", "t.kiln", "nobody")
        check(nobody.err.count("warning") == 1 and "may not read" in nobody.err, f"nobody is told: {nobody.err}")
        check(nobody.remote["hits"] + nobody.remote["sent"] == 0, f"nobody got in: {nobody.remote}")
    # A reader of an empty server sends nothing, however much it has.
    early = build("p/m.yaml", "t.kiln", "--cache", "none", "--cache", main_url, KILN_CACHE_TOKEN_FILE=reader)
    check(early.remote["sent"] == 0 and "read only" in early.err and "warning" not in early.err, f"a reader wrote: {early.remote} {early.err}")
    first = build("p/m.yaml", "t.kiln", "--cache", "none", "--cache", main_url, KILN_CACHE_TOKEN_FILE=writer)
    check(first.remote["sent"] > 10 and first.remote["not_sent"] == 0 and first.err == "", f"the writer: {first.remote} {first.err}")
    for env in ({"KILN_CACHE_TOKEN_FILE": reader}, {"KILN_CACHE_TOKEN": READER}, {"KILN_CACHE_TOKEN_FILE": reader, "KILN_CACHE_TOKEN": STRANGER}):
        warm = build("p/m.yaml", "t.kiln", "--cache", "none", "--cache", main_url, **env)
        same("alone.kiln", "t.kiln", "a reader")
        check(warm.json["work"]["compiled"] == 0 and warm.remote["hits"] == 3 and warm.err == "", f"a reader has no hits: {warm.remote} {warm.err}")
    # A token that others may read, an empty one, one of two lines: a warning, and no server.
    for name, text, mode in (("open", WRITER, 0o644), ("empty", "\n", 0o600), ("two", WRITER + "\nX-Evil: 1", 0o600)):
        bad = build("p/m.yaml", "t.kiln", "--cache", "none", "--cache", main_url, KILN_CACHE_TOKEN_FILE=own_file(name, text, mode))
        same("alone.kiln", "t.kiln", name)
        check(bad.err.count("warning") == 1 and bad.remote is None and WRITER not in bad.err, f"{name}: {bad.err}")
    # What is wrong with the command line is said at once; no password is repeated.
    for words, env in (
        (["--cache", f"http://user:hunter2@127.0.0.1:{server.port}/"], {}),
        (["--cache", "ftp://127.0.0.1/"], {}),
        (["--cache", main_url, "--cache", server.url], {}),
        (["--cache", "a", "--cache", "b"], {}),
        (["--cache", main_url, "--cache-timeout", "soon"], {}),
        (["--cache", "http://192.0.2.1:80/"], {"KILN_CACHE_TOKEN": WRITER}),  # in clear text, over a network
        ([], {"KILN_CACHE": f"{main_url}/../x"}),
    ):
        said = Run("build", "p/m.yaml", "-o", "t.kiln", *words, code=2, **env).err
        check("hunter2" not in said and WRITER not in said, f"a secret was printed: {said}")
    for what in ("verify", "gc", "clear"):  # these are of folders
        Run("cache", what, "--cache", main_url, code=2)


def keys_of(server):
    return {line.split("/pr/1/ac/")[1][:64] for line in server.log().splitlines() if '"PUT"' in line and "/pr/1/ac/" in line}


def conflicts(server, writer):
    """Records that another wrote first under the same keys stay, and the build says so."""
    shutil.copytree("p", "q")
    source = pathlib.Path("q/paint.frag")
    source.write_text(source.read_text().replace("0.5", "0.125"))
    build("q/m.yaml", "alone_q.kiln", "--cache", "none")
    url = server.url + "/pr/1"
    made = build("q/m.yaml", "t.kiln", "--cache", "none", "--cache", url, KILN_CACHE_TOKEN_FILE=writer)
    # The other instance gets the same keys with values of no use.
    for _ in range(100):  # the log comes after the answers
        keys = keys_of(server)
        if len(keys) > 5:
            break
        time.sleep(0.05)
    check(len(keys) > 5, f"too few keys were seen: {len(keys)}, {made.remote}")
    for key in keys:
        status = server.call("PUT", f"/pr/2/ac/{key}", b"*\x05other", token=WRITER).status
        check(status in (200, 201), f"the control: writing first gave {status}")
    late = build("q/m.yaml", "t.kiln", "--cache", "none", "--cache", server.url + "/pr/2", KILN_CACHE_TOKEN_FILE=writer)
    same("alone_q.kiln", "t.kiln", "values of no use")
    check(late.remote["corrupt"] > 0 and late.err.count("warning") == 1, f"values of no use: {late.remote} {late.err}")


def mishaps(server, writer):
    shutil.copytree(ROOT / "uber", "uber")
    shutil.copytree(ROOT / "manifests", "manifests")
    build("manifests/sky_light.yaml", "sky.kiln", "--cache", "none")
    url, hurt = server.url + "/pr/3", 0
    for seed in range(1, 6):
        for spec in ("loss=0.3", "error=0.2", "flip=0.4", "loss=0.2,error=0.1,flip=0.2,delay=1"):
            run = build("manifests/sky_light.yaml", "t.kiln", "--cache", f"sky{seed % 2}", "--cache", url, "--chaos", f"seed={seed},{spec}",
                        KILN_CACHE_TOKEN_FILE=writer)
            same("sky.kiln", "t.kiln", f"seed={seed},{spec}")
            hurt += run.remote["failures"] + run.remote["corrupt"]
            shutil.rmtree(f"sky{seed % 2}")
    check(hurt > 10, "nothing was hurt")
    # Whatever was lost on the way, what the server holds is right.
    calm = build("manifests/sky_light.yaml", "t.kiln", "--cache", "none", "--cache", url, KILN_CACHE_TOKEN_FILE=writer)
    same("sky.kiln", "t.kiln", "after the mishaps")
    check(calm.remote["corrupt"] == 0, f"something wrong was kept: {calm.remote}")


def certificate(name):
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj", f"/CN={name}",
                    "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", f"{name}.key", "-out", f"{name}.pem"], check=True, capture_output=True)
    os.chmod(f"{name}.key", 0o600)
    return os.path.abspath(f"{name}.pem"), os.path.abspath(f"{name}.key")


def encrypted(writer):
    (good, key), (other, _) = certificate("good"), certificate("other")
    with Cached(CACHED, instances=INSTANCES, tokens=TOKENS, tls_certificate=good, tls_key=key) as server:
        check(server.url.startswith("https://"), server.url)
        url = server.url + "/main"
        first = build("p/m.yaml", "t.kiln", "--cache", "none", "--cache", url, KILN_CACHE_TOKEN_FILE=writer, KILN_CACHE_CA=good)
        check(first.remote["sent"] > 10 and first.err == "", f"over TLS: {first.remote} {first.err}")
        second = build("p/m.yaml", "t.kiln", "--cache", "none", "--cache", url, KILN_CACHE_TOKEN_FILE=writer, KILN_CACHE_CA=good)
        same("alone.kiln", "t.kiln", "TLS")
        check(second.remote["hits"] == 3, f"no hits over TLS: {second.remote}")
        # A certificate that nobody vouches for, another's, and plain HTTP spoken to TLS.
        for ca, where in ((other, url), ("", url), ("/nowhere.pem", url), ("", f"http://127.0.0.1:{server.port}/main")):
            bad = build("p/m.yaml", "t.kiln", "--cache", "none", "--cache", where, KILN_CACHE_TOKEN_FILE=writer, KILN_CACHE_CA=ca)
            same("alone.kiln", "t.kiln", f"TLS, {ca}")
            check(bad.remote["hits"] == 0 and bad.remote["failures"] > 0 and bad.err.count("warning") == 1, f"{ca}: {bad.remote} {bad.err}")


in_folder(main)
print("tokens: ok")
