#!/usr/bin/env python3
"""Clients that others wrote: curl, Bazel over HTTP, ccache over HTTP. usage: peers_test.py KILN_CACHED [TEST...]"""
import pathlib
import re
import shutil
import subprocess
import tempfile

from cached import SKIP, Cached, check, equal, key, main

skipped = []


def missing(test, *programs):
    gone = [p for p in programs if shutil.which(p) is None]
    if gone:
        skipped.append(f"{test}: {', '.join(gone)} is not installed")
    return bool(gone)


def run(words, where=None, **environment):
    done = subprocess.run([str(w) for w in words], cwd=where, env=environment or None, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=200)
    return done.returncode, done.stdout.decode(errors="replace")


def curl(binary):
    """Whole and resumable uploads as curl does them: Expect: 100-continue, chunks, zstd, Basic."""
    if missing("curl", "curl", "zstd"):
        return
    secret = "curls-own-secret-token"
    with Cached(binary, instances=["name: main"], tokens=[f"ci {secret} main:read,cas-write,ac-write"]) as server:
        home = server.home
        (home / "netrc").write_text(f"machine 127.0.0.1 login ci password {secret}\n")
        large = b"0123456789" * 400_000
        name = key(large)
        (home / "large").write_bytes(large)
        subprocess.run(["zstd", "-q", str(home / "large")], check=True)
        url = f"{server.url}/main/cas/{name}"
        ask = lambda *more: run(["curl", "-sS", "-m", "30", "-o", home / "out", "-w", "%{http_code}", "--netrc-file", home / "netrc", *more])
        equal(ask(url), (0, "404"), "GET of nothing")
        equal(ask("-T", home / "large", url), (0, "201"), "PUT with Expect: 100-continue")
        equal(ask(url), (0, "200"), "GET")
        equal((home / "out").read_bytes(), large, "its bytes")
        equal(ask("-I", url), (0, "200"), "HEAD")
        equal(ask("-T", home / "large", "-H", "Transfer-Encoding: chunked", url), (0, "200"), "PUT in chunks")
        equal(ask("-T", home / "large.zst", "-H", "Content-Encoding: zstd", url), (0, "200"), "PUT as zstd")
        equal(ask("--http1.0", url), (0, "200"), "GET by HTTP/1.0")
        equal((home / "out").read_bytes(), large, "its bytes")
        equal(ask("-T", home / "large", url[:-1] + ("0" if url[-1] != "0" else "1")), (0, "400"), "PUT under another name")
        code, said = run(["curl", "-sS", "-m", "30", "-o", home / "out", "-w", "%{http_code}", "-T", home / "large", url])
        equal(said[-3:], "401", f"PUT without a token ({code})")


BUILD = '''genrule(name="a", srcs=["in.txt"], outs=["a.txt"], cmd="tr a-z A-Z < $(location in.txt) > $@")
genrule(name="b", srcs=["a.txt"], outs=["b.txt"], cmd="cat $< $< > $@")
'''


def bazel(binary):
    """Cold; in a fresh output root everything is a remote hit; with a blob changed on disk it is built again; read-only tokens."""
    if missing("bazel", "bazel"):
        return
    secrets = {"ci": "the-secret-token-of-ci", "dev": "the-secret-token-of-dev"}
    tokens = [f"ci {secrets['ci']} main:read,cas-write,ac-write", f"dev {secrets['dev']} main:read"]
    roots = []
    try:
        with Cached(binary, instances=["name: main"], tokens=tokens) as server, tempfile.TemporaryDirectory() as home:
            work = pathlib.Path(home) / "work"
            work.mkdir()
            (work / "WORKSPACE").write_text('workspace(name="t")\n')
            (work / "BUILD").write_text(BUILD)
            (work / "in.txt").write_text("hello\n")

            def build(who, *more):
                roots.append(tempfile.mkdtemp(prefix="kiln-bazel-"))
                code, said = run(["bazel", "--batch", f"--output_user_root={roots[-1]}", "build", "//:b", "--jobs=1", "--color=no", "--curses=no",
                                  f"--remote_cache={server.url}/main", f"--remote_header=Authorization=Bearer {secrets[who]}", *more], work)
                if code != 0 and "processes" not in said:
                    print(said[-1500:])
                equal(code, 0, "bazel's exit code")
                equal((work / "bazel-bin/b.txt").read_text(), "HELLO\nHELLO\n", "what was built")
                hits = re.search(r"(\d+) remote cache hit", said)
                return int(hits.group(1)) if hits else 0, said

            equal(build("ci")[0], 0, "hits of a cold cache")
            equal(build("dev")[0], 2, "hits of a reader")
            product = server.blob_path(key(b"HELLO\n"))
            product.write_bytes(b"WRONG\n")
            hits, said = build("ci")
            equal(hits, 1, "hits with one blob changed on disk")
            equal(product.read_bytes(), b"HELLO\n", "the blob was put right")
            (work / "in.txt").write_text("HELLO\n")  # other input, written by one who may only read
            before = sorted((server.folder / "action").rglob("*"))
            equal(build("dev")[0] <= 1, True, "hits of what nobody has built")
            equal(sorted((server.folder / "action").rglob("*")), before, "a reader wrote an action")
    finally:
        for root in roots:
            subprocess.run(["chmod", "-R", "u+w", root], check=False)
            shutil.rmtree(root, ignore_errors=True)


def ccache(binary):
    """ccache keeps its own records under /ac, which needs an opaque instance; both of its layouts."""
    if missing("ccache", "ccache", "gcc"):
        return
    with Cached(binary, instances=["name: main", "name: ccache, opaque: true"]) as server, tempfile.TemporaryDirectory() as home:
        source = pathlib.Path(home) / "a.c"
        source.write_text("int answer(void) { return 42; }\n")

        def compile_(layout, where, fresh):
            local = tempfile.mkdtemp(dir=home)
            environment = {"PATH": "/usr/bin:/bin", "HOME": home, "CCACHE_DIR": local, "CCACHE_CONFIGPATH": "/dev/null", "CCACHE_NOHASHDIR": "1",
                           "CCACHE_SECONDARY_STORAGE": f"{server.url}/{where}|layout={layout}", "CCACHE_REMOTE_STORAGE": f"{server.url}/{where}|layout={layout}"}
            code, said = run(["ccache", "gcc", "-c", source, "-o", pathlib.Path(home) / "a.o"], home, **environment)
            equal(code, 0, "ccache: " + said)
            code, stats = run(["ccache", "--print-stats"], home, **environment)
            values = dict(line.split("\t") for line in stats.splitlines() if "\t" in line)
            hits = sum(int(values.get(n, 0)) for n in ("secondary_storage_hit", "remote_storage_hit"))
            errors = sum(int(values.get(n, 0)) for n in ("secondary_storage_error", "remote_storage_error"))
            equal(errors, 0, f"errors of {layout} {fresh}")
            return hits

        equal(compile_("bazel", "ccache", "cold"), 0, "hits of a cold cache")
        check(compile_("bazel", "ccache", "warm") > 0, "no hit by the second compile")
        equal(compile_("subdirs", "ccache/dav", "cold"), 0, "hits of a cold cache below /dav")
        check(compile_("subdirs", "ccache/dav", "warm") > 0, "no hit by the second compile below /dav")


if __name__ == "__main__":
    try:
        main([curl, bazel, ccache])
    except SystemExit as end:
        for reason in skipped:
            print("SKIP: " + reason)
        raise SystemExit(SKIP if skipped and end.code == 0 else end.code)
