#!/usr/bin/env python3
"""Bazel 7.7 with kiln-cached as its remote cache. Its 600 MB are fetched only on demand: KILN_PEERS_BAZEL=yes or tools/peers.sh --bazel.

usage: newer_bazel_test.py KILN_CACHED [TEST...]
"""
import os
import re

from cached import Cached, check, equal, key, main, skip
from peers import Home, Peers, has_bazel, run

peers = None


class Workspace:
    """Two rules, one on the other, in a workspace that fetches nothing."""

    def __init__(self, home):
        self.home, self.path, self.builds = home, home / "ws", 0
        self.path.mkdir()
        (self.path / "WORKSPACE").write_text('workspace(name="t")\n')
        (self.path / "in.txt").write_text("hello\n")
        (self.path / "BUILD").write_text(
            'genrule(name="a", srcs=["in.txt"], outs=["a.txt"], cmd="tr a-z A-Z < $(location in.txt) > $@")\n'
            'genrule(name="b", srcs=["a.txt"], outs=["b.txt"], cmd="cat $(location a.txt) $(location a.txt) > $@")\n')

    def build(self, *flags):
        """A build from nothing: the counts of its processes by kind, its output's text and what Bazel said."""
        self.builds += 1
        said = run(peers.inside("bazel", "--batch", f"--output_user_root={self.home}/root{self.builds}", "build", "//:b", "--jobs=1",
                                "--noenable_bzlmod", "--enable_workspace", "--spawn_strategy=local", *flags), self.path, timeout=250)
        line = re.search(r"INFO: \d+ processes?: (.*)\.", said)
        check(line, "Bazel does not say what it ran: " + said[-2000:])
        counts = {kind: int(n) for n, kind in re.findall(r"(\d+) ([a-z ]+)", line.group(1))}
        return counts, (self.path / "bazel-bin" / "b.txt").read_bytes(), said


def http(binary):
    """Cold, hits, a poisoned blob that is found and made again, a wrong token that costs hits and no build."""
    tokens = ("ci token-of-the-builder main:read,cas-write,ac-write",)
    with Cached(binary, ("name: main",), tokens, verify_again="0") as server, Home() as home:
        work = Workspace(home)
        flags = (f"--remote_cache={server.url}/main", "--remote_header=Authorization=Bearer token-of-the-builder")
        counts, cold, _ = work.build(*flags)
        equal((counts.get("local"), counts.get("remote cache hit")), (2, None), "cold")
        counts, text, _ = work.build(*flags)
        equal((counts.get("local"), counts.get("remote cache hit")), (None, 2), "again")
        equal(text, cold, "b.txt from the cache")

        poisoned = server.blob_path(key(cold))
        data = bytearray(poisoned.read_bytes())
        data[-1] ^= 1
        poisoned.write_bytes(data)
        counts, text, _ = work.build(*flags)
        equal((counts.get("local"), counts.get("remote cache hit")), (1, 1), "with a poisoned blob")
        equal(text, cold, "b.txt made again")
        equal(work.build(*flags)[0].get("remote cache hit"), 2, "hits after it was mended")

        counts, text, said = work.build(flags[0], "--remote_header=Authorization=Bearer a-token-of-nobody")
        equal((counts.get("local"), counts.get("remote cache hit")), (2, None), "a stranger")
        equal(text, cold, "the stranger's own b.txt")
        check("401" in said, "Bazel was not refused: " + said[-1500:])


if __name__ == "__main__":
    if not has_bazel() and os.environ.get("KILN_PEERS_BAZEL") != "yes":
        skip("Bazel 7.7 is not unpacked (tools/peers.sh --bazel)")
    peers = Peers(bazel=True)
    main([http])
