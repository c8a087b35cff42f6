#!/usr/bin/env python3
"""sccache 0.17 over WebDAV and ccache 4.14 over HTTP: compiled once, then taken from kiln-cached; nothing without the token.

usage: newer_ccache_test.py KILN_CACHED [TEST...]
"""
import re

from cached import Cached, check, equal, main
from peers import Daemon, Home, Peers, free_port, run

SOURCE = "int times_three(int x) { return x * 3; }\n"
TOKENS = ("ci token-of-the-builder main:read,cas-write,ac-write ccache:read,cas-write,ac-write",
          "dev token-of-a-reader main:read ccache:read")
INSTANCES = ('name: main', "name: ccache, opaque: true")
peers = None


def counter(text, name):
    found = re.search(rf"^ *{name}:? +(\d+)", text, re.M)
    check(found, f"no '{name}' in {text}")
    return int(found.group(1))


def sccache(binary):
    """One compilation, its object from another sccache with nothing of its own, whatever the endpoint's last slash."""
    with Cached(binary, INSTANCES, TOKENS) as server, Home() as home:
        (home / "x.c").write_text(SOURCE)

        def compile_as(name, token, end=""):
            port = free_port()
            environment = {"SCCACHE_SERVER_PORT": str(port), "SCCACHE_WEBDAV_ENDPOINT": server.url + "/main/dav" + end, "SCCACHE_NO_DAEMON": "1",
                           "SCCACHE_START_SERVER": "1", "SCCACHE_WEBDAV_TOKEN": token, "SCCACHE_DIR": str(home / "local")}
            with Daemon(peers.inside("sccache"), home, port, **environment):
                client = {k: v for k, v in environment.items() if k not in ("SCCACHE_START_SERVER", "SCCACHE_NO_DAEMON")}
                run(peers.inside("sccache", "gcc", "-c", "x.c", "-o", name), home, **client)
                text = run(peers.inside("sccache", "-s"), home, **client)
            return [counter(text, f"Cache {what}") for what in ("hits", "misses", "read errors", "write errors")]

        equal(compile_as("a.o", "token-of-the-builder"), [0, 1, 0, 0], "cold: hits, misses, read and write errors")
        equal(compile_as("b.o", "token-of-the-builder", "/"), [1, 0, 0, 0], "again")
        equal(compile_as("c.o", "token-of-a-reader"), [1, 0, 0, 0], "a reader")
        equal((home / "a.o").read_bytes(), (home / "b.o").read_bytes(), "objects")
        (home / "x.c").write_text(SOURCE.replace("3", "5"))
        equal(compile_as("d.o", "token-of-a-reader")[0], 0, "hits of other source")
        equal(compile_as("e.o", "token-of-the-builder")[0], 0, "a reader's object was stored")


def ccache(binary):
    """As above with ccache, which puts opaque values under /ac/; a wrong token costs hits and nothing else."""
    with Cached(binary, INSTANCES, TOKENS) as server, Home() as home:
        (home / "x.c").write_text(SOURCE)

        def compile_as(name, token):
            environment = {"CCACHE_DIR": home / ("cache-" + name), "CCACHE_REMOTE_ONLY": "true",
                           "CCACHE_REMOTE_STORAGE": f"{server.url}/ccache layout=bazel bearer-token={token}"}
            run(peers.inside("ccache", "gcc", "-c", "x.c", "-o", name), home, **environment)
            text = run(peers.inside("ccache", "--print-stats"), home, **environment)
            return [int(re.search(rf"^{what}\t(\d+)", text, re.M).group(1)) for what in ("direct_cache_hit", "cache_miss")]

        equal(compile_as("a.o", "token-of-the-builder"), [0, 1], "cold: hits, misses")
        equal(compile_as("b.o", "token-of-the-builder"), [1, 0], "again")
        equal(compile_as("c.o", "token-of-a-reader"), [1, 0], "a reader")
        equal((home / "a.o").read_bytes(), (home / "b.o").read_bytes(), "objects")
        equal(compile_as("d.o", "a-token-of-nobody"), [0, 1], "a stranger")
        equal((home / "a.o").read_bytes(), (home / "d.o").read_bytes(), "the stranger's own object")


if __name__ == "__main__":
    peers = Peers()
    main([sccache, ccache])
