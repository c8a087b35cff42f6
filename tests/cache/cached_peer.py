#!/usr/bin/env python3
"""kiln build against kiln-cached: over gRPC cold and hits, shared with HTTP; roles, pull requests and TLS over both; streams; a
server that is killed, and one that is no gRPC server. usage: cached_peer.py KILN_CACHED"""
import contextlib
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import threading
import time

# Both folders have a peers.py; this folder's is meant.
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "server"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from cached import SKIP, Cached, Failed
from peers import KILN, Run, build, check, environment, in_folder, same

CACHED = sys.argv[1]
skipped = []
ROOT = pathlib.Path(__file__).resolve().parents[2]
WRITER, READER, PULL, BLOBS = (word + "-of-this-test-alone" for word in ("writers-token", "readers-token", "pull-requests-token", "blobs-alone-token"))


class Grpc(Cached):
    def __init__(self, **more):
        super().__init__(CACHED, grpc="127.0.0.1:0", **more)
        line = self.process.stdout.readline().decode().split()
        if not line or line[0] != "grpc":
            raise Failed("no gRPC port: " + self.log())
        self.grpc_port = int(line[1].rsplit(":", 1)[1])
        self.grpc = f"grpc{'s' if self.secure else ''}://127.0.0.1:{self.grpc_port}"
        self.by = {"grpc": self.grpc, "http": self.url}


def remote(table, url, *words, manifest="p/m.yaml", **env):
    return build(manifest, table, "--cache", "none", "--cache", url, *words, **env)


def warnings(run):
    return run.err.count("warning")


def hits():
    with Grpc() as server:
        one = remote("one.kiln", server.grpc)
        same("alone.kiln", "one.kiln", "the first build")
        check(one.json["work"]["compiled"] > 0 and one.remote["hits"] == 0, f"found something in an empty server: {one.remote}")
        check(one.remote["sent"] > 10 and one.remote["not_sent"] == 0 and one.remote["failures"] == 0, f"not sent: {one.remote}")
        two = build("p/m.yaml", "two.kiln", "--cache", "c2", "--cache", server.grpc)
        same("alone.kiln", "two.kiln", "the second build")
        check(two.json["work"]["compiled"] == 0 and two.remote["hits"] == 3 and two.remote["misses"] == 0, f"no pure hits: {two.remote}")
        check(one.err == "" and two.err == "", f"said: {one.err}{two.err}")
        check(build("p/m.yaml", "two.kiln", "--cache", "c2").json["work"]["compiled"] == 0, "remote hits were not kept")
        # What came by one protocol is there for the other, both ways.
        by_http = remote("three.kiln", server.url)
        check(by_http.remote["hits"] == 3 and by_http.json["work"]["compiled"] == 0, f"HTTP found {by_http.remote}")
        shutil.copytree("p", "q")
        source = pathlib.Path("q/paint.frag")
        source.write_text(source.read_text().replace("vec3(0.5)", "vec3(0.25)"))
        check(remote("four.kiln", server.url, manifest="q/m.yaml").json["work"]["compiled"] > 0, "the changed shader was known")
        check(remote("five.kiln", server.grpc, manifest="q/m.yaml").remote["hits"] == 3, "gRPC does not find what HTTP wrote")
        # Equal tokens in other files: modules and texts by batches.
        source.write_text(source.read_text() + "// a remark\n")
        six = remote("six.kiln", server.grpc, manifest="q/m.yaml")
        same("five.kiln", "six.kiln", "a build with a remark")
        check(six.json["work"]["compiled"] == 0 and six.json["work"]["preprocessed"] > 0 and six.remote["hits"] > 10, f"batches: {six.remote}")
        # Read-only sends nothing; there is something to send.
        source.write_text(source.read_text().replace("0.25", "0.75"))
        seven = remote("seven.kiln", server.grpc, "--cache-read-only", manifest="q/m.yaml")
        check(seven.json["work"]["compiled"] > 0 and seven.remote["sent"] == 0, f"read-only sent {seven.remote}")
        check(remote("eight.kiln", server.grpc, manifest="q/m.yaml").json["work"]["compiled"] > 0, "read-only had sent something")


def roles(protocol):
    tokens = [f"main {WRITER} main:read,cas-write,ac-write", f"dev {READER} main:read", f"blobs {BLOBS} main:read,cas-write",
              f"pull {PULL} main:read pr/*:read,cas-write,ac-write"]
    with Grpc(instances=["name: main", "name: pr/*, parent: main"], tokens=tokens) as server:
        base = server.by[protocol]
        main, pull = base + "/main", base + "/pr/7"
        outputs = []

        def run(table, url, token, **more):
            got = remote(table, url, **({"KILN_CACHE_TOKEN": token} if token else {}), **more)
            outputs.append(got.out + got.err)
            return got

        # A token that may not write actions is no failure. Over gRPC it is known beforehand, and nothing is tried.
        for token in (READER, BLOBS):
            got = run("reader.kiln", main, token)
            same("alone.kiln", "reader.kiln", "an empty server with a reader")
            check(got.remote["failures"] == 0 and warnings(got) == 0, f"reader: {got.remote} {got.err}")
            check(got.remote["sent"] == 0 or (token == BLOBS and protocol == "http"), f"a reader sent: {got.remote}")
            check(not any(p.is_file() for p in (server.folder / "action").rglob("*")), "a reader wrote an action")
        # Without a token, with a wrong one: the build is made, with one warning.
        for token in ("", "a-token-that-nobody-knows"):
            got = run("none.kiln", main, token)
            same("alone.kiln", "none.kiln", "no token")
            check(got.json["work"]["compiled"] > 0 and warnings(got) == 1, f"no token: {got.err}")
        # A pull request writes its own instance and never main, whatever it asks for.
        check(run("pr.kiln", main, PULL).remote["sent"] == 0, "a pull request wrote main")
        check(run("pr.kiln", pull, PULL).remote["sent"] > 10, "a pull request may not write its own")
        check(run("pr.kiln", pull, PULL).remote["hits"] == 3, "a pull request does not find its own")
        check(run("main.kiln", main, READER).remote["hits"] == 0, "main reads a pull request's")
        check(run("main.kiln", main, WRITER).remote["sent"] > 10, "main's writer may not write")
        check(run("reader.kiln", main, READER).remote["hits"] == 3, "a reader does not find what main wrote")
        other = run("pr8.kiln", base + "/pr/8", PULL)
        check(other.remote["hits"] == 3 and other.json["work"]["compiled"] == 0, "another pull request does not read main")
        same("alone.kiln", "pr8.kiln", "through main")
        check(warnings(run("bad.kiln", base + "/nowhere", WRITER)) == 1, "an instance that is not there was no warning")
        said = "".join(outputs) + server.log()
        for secret in (WRITER, READER, PULL, BLOBS):
            check(secret not in said, "a token was said aloud")


def probes():
    tokens = [f"dev {READER} main:read"]
    with Grpc(instances=["name: main"], tokens=tokens) as server:
        for base in server.by.values():
            env = {"KILN_CACHE_TOKEN": READER}
            told = Run("cache", "stats", "--cache", base + "/main", "--json", **env).json
            check(told["reads"] and told["problem"] == "" and told["server"] == base + "/main", f"stats: {told}")
            check("may read" in Run("cache", "stats", "--cache", base + "/main", **env).out, "stats in words")
            told = Run("cache", "stats", "--cache", base + "/main", "--json", code=3).json
            check(not told["reads"] and told["problem"] != "", f"stats without a token: {told}")
            for verb in ("verify", "gc", "clear"):
                Run("cache", verb, "--cache", base + "/main", code=2, **env)
        server.stop()
        for base in server.by.values():
            check("kiln: error" in Run("cache", "stats", "--cache", base + "/main", code=3).err, "a server that is gone")
        server.stop = lambda: 0


def tls(protocol):
    if shutil.which("openssl") is None:
        skipped.append("TLS: no openssl here")
        return
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj", "/CN=127.0.0.1",
                    "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", "key.pem", "-out", "cert.pem"], check=True, stderr=subprocess.DEVNULL)
    with Grpc(instances=["name: main"], tokens=[f"ci {WRITER} main:read,cas-write,ac-write"], tls_certificate="cert.pem", tls_key="key.pem") as server:
        good = {"KILN_CACHE_TOKEN": WRITER, "KILN_CACHE_CA": "cert.pem"}
        check(remote("tls.kiln", server.by[protocol] + "/main", **good).remote["sent"] > 10, "nothing sent over TLS")
        check(remote("tls.kiln", server.by[protocol] + "/main", **good).remote["hits"] == 3, "no hits over TLS")
        # A certificate that nobody vouches for; plain text to a TLS port.
        for url in (server.by[protocol] + "/main", server.by[protocol].replace(f"{protocol}s", protocol) + "/main"):
            got = remote("tls.kiln", url, KILN_CACHE_TOKEN=WRITER)
            same("alone.kiln", "tls.kiln", url)
            check(got.remote["hits"] == 0 and got.remote["sent"] == 0 and warnings(got) == 1, f"{url}: {got.remote} {got.err}")


def streams():
    """A blob larger than a message: the table of a build whose targets are many."""
    shutil.copytree(ROOT / "uber", "uber")
    shutil.copytree(ROOT / "manifests", "manifests")
    with Grpc() as server:
        remote("big.kiln", server.grpc, manifest="manifests/surface.yaml")
        large = [p for p in (server.folder / "blob").rglob("*") if p.is_file() and p.stat().st_size > 3 * 1024 * 1024]
        check(large, "no blob needs a stream: this test shows nothing")
        again = remote("big2.kiln", server.grpc, manifest="manifests/surface.yaml")
        same("big.kiln", "big2.kiln", "streams")
        check(again.json["work"]["compiled"] == 0 and again.remote["hits"] == 3, f"streams: {again.remote}")
        # The server ends while it is asked. What it could give is lost, one thing after another.
        for place in (server.folder / "action").rglob("*"):
            if place.is_file() and place.stat().st_size < 400:
                place.unlink()
        process = subprocess.Popen([KILN, "build", "manifests/surface.yaml", "-o", "torn.kiln", "--cache", "none", "--cache", server.grpc],
                                   env=environment(KILN_CACHE_TIMEOUT="1"), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        time.sleep(0.4)
        server.process.kill()
        server.process.wait()
        err = process.communicate(timeout=120)[1]
        check(process.returncode == 0, f"the build failed with its server: {err}")
        same("big.kiln", "torn.kiln", "a server that was killed")
        check(err.count("warning") <= 1, f"more than one warning: {err}")
        server.stop = lambda: 0


def chaos(protocol):
    """A server that hurts whoever asks it: the table is the one that is built alone, whatever the seed; counters tell what was done."""
    what = {}
    works = set()
    for seed in range(1, 5):
        with Grpc(chaos=f"seed={seed},loss=0.2,error=0.1,flip=0.3,delay=3") as server:
            check('"kind":"chaos"' in server.log(), "no word of it in the log")
            for step in range(3):
                got = remote("hurt.kiln", server.by[protocol])
                same("alone.kiln", "hurt.kiln", f"chaos, seed {seed}")
                works.add(got.json["work"]["compiled"])
                for name in ("failures", "corrupt", "misses", "hits"):
                    what[name] = what.get(name, 0) + got.remote[name]
            for line in server.call("GET", "/metrics").body.decode().splitlines():
                if line.startswith("kiln_cached_chaos_total{"):
                    what[line.split('"')[1]] = what.get(line.split('"')[1], 0) + float(line.split()[-1])
    check(all(what.get(name, 0) > 0 for name in ("failures", "corrupt", "lost", "failed", "flipped", "delayed", "misses", "hits")), f"not hurt: {what}")
    check(len(works) > 1, f"no build had other work than another: {works}")


@contextlib.contextmanager
def speaks(answer):
    """A port that answers bytes which are no gRPC; None: nothing, for ever."""
    listener = socket.create_server(("127.0.0.1", 0))
    kept = []

    def serve():
        with contextlib.suppress(OSError):
            while True:
                peer, _ = listener.accept()
                kept.append(peer)
                if answer is not None:
                    peer.sendall(answer)
                    peer.close()

    threading.Thread(target=serve, daemon=True).start()
    try:
        yield f"grpc://127.0.0.1:{listener.getsockname()[1]}"
    finally:
        listener.close()
        for peer in kept:
            peer.close()


def no_server():
    settings = b"\0\0\0\x04\0\0\0\0\0"
    for what, answer in (("nothing", None), ("HTTP/1.1", b"HTTP/1.1 200 OK\r\nContent-Length: 3\r\n\r\nyes"), ("noise", os.urandom(4096)),
                         ("a frame without an end", settings + b"\xff\xff\xff\0\0\0\0\0\x01" + b"x" * 4096), ("settings alone", settings)):
        with speaks(answer) as url:
            got = remote("wrong.kiln", url, KILN_CACHE_TIMEOUT="0.5")
        same("alone.kiln", "wrong.kiln", what)
        check(got.json["work"]["compiled"] > 0 and warnings(got) == 1 and len(got.err.splitlines()) <= 2, f"{what}: {got.err}")
    with socket.create_server(("127.0.0.1", 0)) as taken:  # bound and then closed: nobody listens
        port = taken.getsockname()[1]
    got = remote("wrong.kiln", f"grpc://127.0.0.1:{port}")
    same("alone.kiln", "wrong.kiln", "nobody")
    check(warnings(got) == 1, f"nobody: {got.err}")


def main():
    build("p/m.yaml", "alone.kiln", "--cache", "none")
    for test, *words in ((hits,), (probes,), (roles, "grpc"), (roles, "http"), (tls, "grpc"), (tls, "http"), (chaos, "grpc"), (chaos, "http"), (no_server,), (streams,)):
        began = time.monotonic()
        test(*words)
        print(f"{' '.join([test.__name__, *words])}: {'skipped' if skipped and test is tls else 'ok'}, {time.monotonic() - began:.1f} s", flush=True)


in_folder(main)
for reason in skipped:
    print("SKIP: " + reason)
sys.exit(SKIP if skipped else 0)
