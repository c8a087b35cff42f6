#!/usr/bin/env python3
"""Debian's Bazel with kiln-cached as its remote cache over gRPC. (By TLS this Bazel ends without a word; that is tests/unit/server_grpc.)

usage: bazel_grpc_test.py KILN_CACHED [TEST...]
"""
import pathlib
import re
import shutil
import subprocess
import tempfile

from cached import Cached, check, equal, key, main, skip


class Workspace:
    """A small output and one that is too large for a message, in a workspace that fetches nothing."""

    def __init__(self):
        self.home = pathlib.Path(tempfile.mkdtemp(prefix="kiln-bazel-"))
        self.path, self.builds = self.home / "ws", 0
        self.path.mkdir()
        (self.path / "WORKSPACE").write_text('workspace(name="t")\n')
        (self.path / "in.txt").write_text("hello\n")
        (self.path / "BUILD").write_text(
            'genrule(name="a", srcs=["in.txt"], outs=["a.txt"], cmd="tr a-z A-Z < $(location in.txt) > $@")\n'
            'genrule(name="b", srcs=["a.txt"], outs=["b.txt"], cmd="for i in 1 2 3 4 5 6; do head -c 1000000 /dev/zero | tr \\\\0 $$i; done | cat $(location a.txt) - > $@")\n')

    def __enter__(self):
        return self

    def __exit__(self, *_):
        subprocess.run(["chmod", "-R", "u+w", str(self.home)], check=False)
        shutil.rmtree(self.home, ignore_errors=True)

    def build(self, *flags):
        """A build from nothing: how many rules ran here, how many were hits, the output, and what Bazel said."""
        self.builds += 1
        root = self.home / f"root{self.builds}"
        done = subprocess.run(["bazel", "--batch", f"--output_user_root={root}", "build", "//:b", "--jobs=1", "--spawn_strategy=local", *flags],
                              cwd=self.path, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=250)
        said = done.stdout.decode(errors="replace")
        line = re.search(r"INFO: \d+ processes?: (.*)\.", said)
        check(done.returncode == 0 and line, "Bazel: " + re.sub(r"(?m)^(Open|INFO|Load).*\n", "", said)[-2000:])
        counts = {kind: int(n) for n, kind in re.findall(r"(\d+) ([a-z ]+)", line.group(1))}
        return counts.get("local", 0), counts.get("remote cache hit", 0), (self.path / "bazel-bin" / "b.txt").read_bytes(), said


def grpc_port(server):
    line = server.process.stdout.readline().decode().split()
    check(len(line) == 2 and line[0] == "grpc", f"no port of gRPC but {line}")
    return int(line[1].rsplit(":", 1)[1])


TOKENS = ("ci token-of-the-builder main:read,cas-write,ac-write", "dev token-of-a-developer main:read")


def plain(binary):
    """Cold, hits, a blob changed on the disk that is found and made again, a reader whose results stay with it, a stranger."""
    with Cached(binary, ("name: main",), TOKENS, grpc="127.0.0.1:0", verify_again="0") as server, Workspace() as work:
        flags = [f"--remote_cache=grpc://127.0.0.1:{grpc_port(server)}", "--remote_instance_name=main"]
        builder = flags + ["--remote_header=Authorization=Bearer token-of-the-builder"]
        ran, hits, cold, _ = work.build(*builder)
        equal((ran, hits), (2, 0), "cold")
        ran, hits, text, _ = work.build(*builder)
        equal((ran, hits), (0, 2), "again")
        equal(text, cold, "b.txt from the cache")

        changed = server.blob_path(key(cold))
        data = bytearray(changed.read_bytes())
        data[1234567] ^= 1
        changed.write_bytes(data)
        ran, hits, text, _ = work.build(*builder)
        equal((ran, hits), (1, 1), "with a changed blob")
        equal(text, cold, "b.txt made again")
        equal(work.build(*builder)[:2], (0, 2), "hits after it was mended")

        (work.path / "in.txt").write_text("other\n")
        reader = flags + ["--remote_header=Authorization=Bearer token-of-a-developer", "--noremote_upload_local_results"]
        # Capabilities say that a reader may not write, and Bazel will not even begin unless it is told not to.
        equal(work.build(*reader)[:2], (2, 0), "a reader with new input")
        equal(work.build(*reader)[:2], (2, 0), "what it made stayed with it")
        (work.path / "in.txt").write_text("hello\n")
        equal(work.build(*reader)[:2], (0, 2), "a reader with the builder's input")

        done = subprocess.run(["bazel", "--batch", f"--output_user_root={work.home}/stranger", "build", "//:b", "--jobs=1", *flags],
                              cwd=work.path, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=250)
        check(done.returncode != 0 and b"UNAUTHENTICATED" in done.stdout, "a stranger: " + done.stdout.decode()[-1500:])


if __name__ == "__main__":
    if not shutil.which("bazel"):
        skip("no bazel (Debian's bazel-bootstrap)")
    main([plain])
