"""Bazel as a client of kiln-cached, over either protocol."""
import re

from cached import Cached, check, equal, key
from peers import Home, run


class Workspace:
    """Two rules, one on the other, the second's output too large for a message of gRPC, in a workspace that fetches nothing."""

    def __init__(self, home, bazel, flags):
        self.path, self.bazel, self.flags = home / "ws", [*bazel, f"--output_user_root={home}/root"], flags
        # A server for all builds; one inside a namespace is not found again from another.
        self.bazel += ["--batch"] if len(bazel) > 1 else ["--max_idle_secs=60"]
        self.path.mkdir()
        (self.path / "WORKSPACE").write_text('workspace(name="t")\n')
        (self.path / "in.txt").write_text("hello\n")
        (self.path / "BUILD").write_text(
            'genrule(name="a", srcs=["in.txt"], outs=["a.txt"], cmd="tr a-z A-Z < $(location in.txt) > $@")\n'
            'genrule(name="b", srcs=["a.txt"], outs=["b.txt"], cmd="for i in 1 2 3 4 5 6; do head -c 1000000 /dev/zero | tr \\\\0 $$i; done | cat $(location a.txt) - > $@")\n')

    def __enter__(self):
        return self

    def __exit__(self, *_):
        run([*self.bazel, "shutdown"], self.path, None)

    def build(self, *flags):
        """A build from nothing: how many actions ran here, how many came from the cache, the output and what Bazel said."""
        run([*self.bazel, "clean", *self.flags], self.path, timeout=250)
        said = run([*self.bazel, "build", "//:b", "--jobs=1", "--spawn_strategy=local", *self.flags, *flags], self.path, timeout=250)
        line = re.search(r"INFO: \d+ processes?: (.*)\.", said)
        check(line, "Bazel does not say what it ran: " + said[-2000:])
        counts = {kind: int(n) for n, kind in re.findall(r"(\d+) ([a-z ]+)", line.group(1))}
        return (counts.get("local", 0), counts.get("remote cache hit", 0)), (self.path / "bazel-bin" / "b.txt").read_bytes(), said


def hits_and_poison(binary, bazel, protocol, *flags):
    """Cold, hits, a reader, a blob poisoned on the server's disk that is made again, a wrong token that costs hits and no build."""
    tokens = ("ci token-of-the-builder main:read,cas-write,ac-write", "dev token-of-a-reader main:read")
    with Cached(binary, ("name: main",), tokens, verify_again="0", grpc="127.0.0.1:0") as server, Home() as home:
        with Workspace(home, bazel, flags) as work:
            remote = (f"--remote_cache={server.url}/main",)
            if protocol == "grpc":
                remote = ("--remote_cache=grpc://" + server.process.stdout.readline().decode().split()[1], "--remote_instance_name=main")

            def build(token, *more):
                if token == "token-of-a-reader":
                    more = ("--noremote_upload_local_results",)
                return work.build(*remote, "--remote_header=Authorization=Bearer " + token, *more)

            if protocol == "grpc":  # the server says whose results it does not want; Bazel 4 then wants to hear that flag
                try:
                    work.build(*remote, "--remote_header=Authorization=Bearer token-of-a-reader")
                except AssertionError as failure:
                    check("not authorized to write" in str(failure), str(failure))
            counts, text, said = build("token-of-a-reader")
            equal(counts, (2, 0), "a reader's cold build: run here, from the cache")
            counts, cold, _ = build("token-of-the-builder")
            equal(counts, (2, 0), "a cold build, after a reader's")
            counts, text, _ = build("token-of-the-builder")
            equal((counts, text), ((0, 2), cold), "again")
            counts, text, _ = build("token-of-a-reader")
            equal((counts, text), ((0, 2), cold), "a reader's")

            poisoned = server.blob_path(key(cold))
            data = bytearray(poisoned.read_bytes())
            data[-1] ^= 1
            poisoned.write_bytes(data)
            counts, text, _ = build("token-of-the-builder")
            equal((counts, text), ((1, 1), cold), "with a poisoned blob")
            equal(build("token-of-the-builder")[0], (0, 2), "after it was mended")

            said = ""
            try:
                counts, text, said = build("a-token-of-nobody")
                equal((counts, text), ((2, 0), cold), "a stranger's own build")
            except AssertionError as failure:  # over gRPC Bazel asks for the server's capabilities first and ends without them
                said = str(failure)
            check("401" in said or "UNAUTHENTICATED" in said, "the stranger was not refused: " + said[-1500:])
