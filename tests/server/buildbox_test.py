#!/usr/bin/env python3
"""buildbox over gRPC: casupload and casdownload; a fleet of two casd nodes whose central store and action cache is kiln-cached,
asked by trexe and recc.

usage: buildbox_test.py KILN_CACHED [TEST...]
"""
import hashlib
import json
import os
import random
import time

from cached import Cached, check, equal, key, main
from peers import Daemon, Home, Peers, free_port, run

INSTANCES = ("name: main",)
TOKENS = ("ci token-of-the-builder main:read,cas-write,ac-write", "dev token-of-a-reader main:read")
peers = None


class Served(Cached):
    """kiln-cached with gRPC; `remote` is what buildbox calls it."""

    def __init__(self, binary, home, **flags):
        # buildbox sends tokens over TLS alone.
        self.certificate, private = home / "server.pem", home / "server.key"
        run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost", "-addext",
             "subjectAltName=IP:127.0.0.1", "-keyout", private, "-out", self.certificate], home)
        super().__init__(binary, INSTANCES, TOKENS, grpc="127.0.0.1:0", tls_certificate=self.certificate, tls_key=private, **flags)
        line = self.process.stdout.readline().decode().split()
        equal(line[:1], ["grpc"], "the second line of kiln-cached")
        self.remote = "https://" + line[1]
        self.token = {}
        for name, token in (("ci", "token-of-the-builder"), ("dev", "token-of-a-reader"), ("nobody", "a-token-of-nobody")):
            self.token[name] = home / f"token-{name}"
            self.token[name].write_text(token)


class Node(Daemon):
    """A casd that runs actions; what it makes goes to the server as well."""

    def __init__(self, server, home, name):
        self.port, self.store = free_port(), home / f"casd-{name}"
        self.remote = f"http://127.0.0.1:{self.port}"
        shared = [f"--{which}-{what}" for which in ("cas", "ac")
                  for what in (f"remote={server.remote}", "instance=main", f"access-token={server.token['ci']}", f"server-cert={server.certificate}", "retry-limit=1")]
        super().__init__(peers.tool("buildbox-casd", f"--bind=127.0.0.1:{self.port}", *shared, "--jobs=1", "--quota-high=1G", "--reserved=1M",
                                    f"--buildbox-run={peers.folder}/bin/buildbox-run-hosttools", self.store), home, self.port)


def files(binary):
    """Small, empty and large blobs and a tree go up and come down the same; a reader uploads nothing, a stranger reads nothing."""
    with Home() as home, Served(binary, home) as server:
        chance = random.Random(1)
        blobs = {"small": b"a small blob", "empty": b"", "large": chance.randbytes(9_000_001)}
        (home / "up").mkdir()
        for name, data in blobs.items():
            (home / "up" / name).write_bytes(data)

        def upload(who, *what, code=0):
            return run(peers.tool("casupload", f"--remote={server.remote}", "--instance=main", f"--access-token={server.token[who]}",
                                  f"--server-cert={server.certificate}",
                                  "--retry-limit=0", *what), home, code)

        def download(who, data, code=0):
            target = home / "down"
            run(["rm", "-rf", target], home)
            said = run(peers.tool("casdownload", f"--remote={server.remote}", "--instance=main", f"--access-token={server.token[who]}",
                                  f"--server-cert={server.certificate}",
                                  "--retry-limit=0", f"--destination-dir={target}", f"--file-digest={key(data)}/{len(data)}"), home, None)
            got = [p.read_bytes() for p in sorted(target.rglob("*")) if p.is_file()] if target.exists() else []
            return (got, said) if code == 0 else (None if got == [] else got, said)

        upload("dev", home / "up" / "small", code=None)
        check(not server.blob_path(key(blobs["small"])).exists(), "a reader's blob was stored")
        for name in blobs:
            upload("ci", home / "up" / name)
        for name, data in blobs.items():
            got, said = download("dev", data)
            equal([key(one) for one in got], [key(data)], f"{name} as it came down: {said[-500:]}")
        got, said = download("nobody", blobs["small"])
        equal(got, [], "what a stranger got")

        upload("ci", f"--output-digest-file={home}/digest", home / "up")
        digest = (home / "digest").read_text().strip()
        run(peers.tool("casdownload", f"--remote={server.remote}", "--instance=main", f"--access-token={server.token['dev']}",
                       f"--server-cert={server.certificate}",
                       f"--destination-dir={home}/tree", f"--root-digest={digest}"), home)
        for name, data in blobs.items():
            found = [p for p in (home / "tree").rglob(name)]
            equal([p.read_bytes() == data for p in found], [True], f"{name} in the tree")


def trexe(home, node, word, out):
    """Asks a node to run an action that only `word` tells from others: whether it was cached, and its output."""
    (home / "in.txt").write_text(f"hello {word}\n")
    run(peers.tool("trexe", f"--remote={node.remote}", f"--input-path={home}/in.txt:in.txt", "--output-path=out.txt", f"--d={out}",
                   "--platform-properties=OSFamily=linux", f"--result-metadata-file={home}/m.json", "--",
                   "/bin/sh", "-c", "tr a-z A-Z < in.txt > out.txt"), home)
    return json.loads((home / "m.json").read_text())["actionResultMetadata"]["cachedResult"], (out / "out.txt").read_text()


def fleet(binary):
    """What one node made, the other takes from the server, also after both have lost their own stores; an action whose output the
    server lost is run again."""
    with Home() as home, Served(binary, home) as server:
        with Node(server, home, "one") as one, Node(server, home, "two") as two:
            equal(trexe(home, one, "a", home / "o1"), (False, "HELLO A\n"), "first on node one")
            equal(trexe(home, two, "a", home / "o2"), (True, "HELLO A\n"), "then on node two")
            equal(trexe(home, two, "b", home / "o3"), (False, "HELLO B\n"), "another action, on node two")
            equal(trexe(home, one, "b", home / "o4"), (True, "HELLO B\n"), "and on node one")
        with Node(server, home, "three") as three:
            equal(trexe(home, three, "a", home / "o5"), (True, "HELLO A\n"), "on a node without a store")
        output = server.blob_path(key(b"HELLO A\n"))
        check(output.exists(), "the server does not hold the output")
        output.unlink()
        with Node(server, home, "four") as four:
            equal(trexe(home, four, "a", home / "o6"), (False, "HELLO A\n"), "after the server lost the output")
        check(output.exists(), "the output was not stored again")


def reader_node(binary):
    """A node with a reader's token: its actions run, nothing of them reaches the server."""
    with Home() as home, Served(binary, home) as server:
        with Node(server, home, "one") as one:
            equal(trexe(home, one, "a", home / "o1")[0], False, "first, by the builder")
        server.token["ci"] = server.token["dev"]
        before = sum(1 for p in (server.folder / "action").rglob("*") if p.is_file())
        check(before > 0, "the builder's action is not there")
        with Node(server, home, "two") as two:
            equal(trexe(home, two, "a", home / "o2"), (True, "HELLO A\n"), "by a reader")
            try:
                trexe(home, two, "poison", home / "o3")
            except AssertionError:
                pass  # casd may fail an action whose outputs it cannot upload
        equal(sum(1 for p in (server.folder / "action").rglob("*") if p.is_file()), before, "actions after a reader's")
        check(not server.blob_path(key(b"HELLO POISON\n")).exists(), "a reader's output was stored")


def recc(binary):
    """A C compiler's actions, made through one node and taken through the other."""
    with Home() as home, Served(binary, home) as server:
        def compile_by(node, name):
            work = home / name
            work.mkdir()
            (work / "b.h").write_text("#define THREE 3\n")
            (work / "b.c").write_text('#include "b.h"\nint f(void) { return THREE; }\n')
            said = run(peers.tool("recc", "/usr/bin/gcc", "-c", "b.c", "-o", "b.o"), work, RECC_SERVER=node.remote, RECC_PROJECT_ROOT=work,
                       RECC_LOG_LEVEL="info", RECC_REMOTE_PLATFORM_OSFamily="linux")
            return "Action Cache hit" in said, (work / "b.o").read_bytes()

        with Node(server, home, "one") as one, Node(server, home, "two") as two:
            hit, first = compile_by(one, "w1")
            equal(hit, False, "a hit before anything was compiled")
            hit, second = compile_by(two, "w2")
            equal(hit, True, "a hit through the other node")
            equal(first, second, "objects")


if __name__ == "__main__":
    peers = Peers()
    main([files, fleet, reader_node, recc])
