#!/usr/bin/env python3
"""Who may do what: every verb with every token, pull requests, the token file, secrets in the log, a reload.

usage: roles_test.py KILN_CACHED [TEST...]
"""
import os
import signal
import subprocess
import tempfile
import pathlib

from cached import Cached, basic, check, equal, key, main

M = "/main"
BLOB, ACTION = b"a blob", key(b"an action")
SECRETS = {name: name[0] * 8 + "-secret-of-" + name for name in ("reader", "cas", "ac", "writer", "admin", "pull", "old")}
TOKENS = ["# who", f"reader {SECRETS['reader']} main:read", f"cas {SECRETS['cas']} main:cas-write", f"ac {SECRETS['ac']} main:ac-write",
          f"writer sha256:{key(SECRETS['writer'].encode())} main:read,cas-write,ac-write", f"admin {SECRETS['admin']} *:admin",
          f"pull {SECRETS['pull']} pr/*:read,cas-write,ac-write main:read", f"old {SECRETS['old']} *:admin until=2020-01-01"]
INSTANCES = ["name: main", 'name: "pr/*", parent: main']


def result(text):
    """An ActionResult with standard output alone."""
    return b"\x2a" + bytes([len(text)]) + text


def served(binary, **more):
    return Cached(binary, instances=INSTANCES, tokens=TOKENS, **more)


def every_verb(binary):
    verbs = {"get blob": ("GET", M + "/cas/" + key(BLOB), None, "read"), "head blob": ("HEAD", M + "/cas/" + key(BLOB), None, "read"),
             "get action": ("GET", M + "/ac/" + ACTION, None, "read"), "get file": ("GET", M + "/dav/a", None, "read"),
             "propfind": ("PROPFIND", M + "/dav/", None, "read"), "put blob": ("PUT", M + "/cas/" + key(BLOB), BLOB, "cas-write"),
             "put action": ("PUT", M + "/ac/" + ACTION, result(b"x"), "ac-write"), "put file": ("PUT", M + "/dav/a", b"f", "ac-write"),
             "mkcol": ("MKCOL", M + "/dav/a/", None, "ac-write"), "metrics": ("GET", "/metrics", None, "read"), "status": ("GET", "/status", None, "read")}
    roles = {"reader": {"read"}, "cas": {"cas-write"}, "ac": {"ac-write"}, "writer": {"read", "cas-write", "ac-write"},
             "admin": {"read", "cas-write", "ac-write"}, "old": None, "nobody": None, "stranger": None}
    with served(binary) as server:
        for path, data in ((M + "/cas/" + key(BLOB), BLOB), (M + "/ac/" + ACTION, result(b"x")), (M + "/dav/a", b"f")):
            check(server.call("PUT", path, data, token=SECRETS["writer"]).status == 201, "positive control " + path)
        for who, has in roles.items():
            token = None if who == "nobody" else SECRETS.get(who, "a-token-that-nobody-has")
            for verb, (method, path, body, role) in verbs.items():
                want = (401,) if has is None else (200, 201, 207) if role in has else (403,)
                got = server.call(method, path, body, token=token)
                check(got.status in want, f"{who}: {verb}: {got.status}, not {want}")
                if got.status == 401:
                    check("WWW-Authenticate" in got.headers, "401 without WWW-Authenticate")
                if got.status in (401, 403):
                    check(BLOB not in got.body and b"x" != got.body, "a refusal with content")
        equal(server.call("GET", "/healthz").status, 200, "/healthz needs no token")
        equal(server.get(BLOB, token=SECRETS["writer"]).status, 403, "the instance without a name, which no grant names")
        for header, want in ((basic(SECRETS["reader"]), 200), (basic("wrong-wrong-wrong-wrong"), 401), ("bearer " + SECRETS["reader"], 200),
                             ("Bearer", 401), ("Bearer " + SECRETS["reader"][:-1], 401), ("Bearer " + SECRETS["reader"] + "x", 401),
                             ("Digest " + SECRETS["reader"], 401), ("Basic !!!", 401), (SECRETS["reader"], 401), ("Bearer sha256:" + key(SECRETS["writer"].encode()), 401),
                             ("Bearer " + "x" * 10_000, 401)):
            equal(server.call("GET", M + "/cas/" + key(BLOB), Authorization=header).status, want, header[:60])
        server.stop()
        log = server.log()
        check(ACTION in log, "positive control: the log has the requests")
        for secret in SECRETS.values():
            check(secret not in log, "a token is in the log")


def refused_early(binary):
    """Whoever may not write is told so before the body is read."""
    with served(binary) as server:
        with server.connect() as s:
            s.sendall(b"PUT /main/cas/" + key(BLOB).encode() + b" HTTP/1.1\r\nHost: h\r\nContent-Length: 6\r\nExpect: 100-continue\r\n\r\n")
            check(s.recv(4096).startswith(b"HTTP/1.1 401"), "no token: asked to go on")
        with server.connect() as s:
            s.sendall(f"PUT /main/cas/{key(BLOB)} HTTP/1.1\r\nHost: h\r\nContent-Length: 6\r\nExpect: 100-continue\r\nAuthorization: Bearer {SECRETS['cas']}\r\n\r\n".encode())
            check(s.recv(4096).startswith(b"HTTP/1.1 100"), "positive control: not asked to go on")


def pull_requests(binary):
    """A pull request reads main, writes its own instance, and whatever it writes is seen by no other."""
    pull, writer, reader = SECRETS["pull"], SECRETS["writer"], SECRETS["reader"]
    evil, good = result(b"evil"), result(b"good")
    with served(binary) as server:
        put = lambda instance, value, token: server.call("PUT", f"{instance}/ac/{ACTION}", value, token=token).status
        get = lambda instance, token: server.call("GET", f"{instance}/ac/{ACTION}", token=token)
        equal(put(M, evil, pull), 403, "a pull request writes main")
        equal(put("/pr/7", evil, pull), 201, "a pull request writes its own")
        equal(get("/pr/7", pull).body, evil, "and reads it")
        equal(get(M, reader).status, 404, "main after that")
        equal(get("/pr/8", pull).status, 404, "another pull request after that")
        equal(put(M, good, writer), 201, "main")
        equal(get(M, reader).body, good, "main's value in main")
        equal(get("/pr/7", pull).body, good, "main's value where a pull request had written its own")
        check(put("/pr/9", evil, pull) in (200, 409), "a pull request over main's value")
        equal(get("/pr/9", pull).body, good, "main's value stays")
        equal(get(M, reader).body, good, "main in the end")
        equal(put(M, result(b"other"), writer), 200, "a conflict is no error")
        equal(get(M, reader).body, good, "the first value stays")
        metrics = server.call("GET", "/metrics", token=reader).body.decode()
        counted = [line for line in metrics.splitlines() if "conflict" in line and line[0] != "#"]
        check(any(float(line.split()[-1]) >= 1 for line in counted), f"conflicts are counted: {counted}")
        equal(put("/pr/7", evil, reader), 403, "a reader of main writes a pull request's")
        equal(put("/nowhere", evil, SECRETS["admin"]), 404, "an instance that is none")
        equal(put(M, result(b"new"), SECRETS["admin"]), 200, "an admin")
        equal(get(M, reader).body, result(b"new"), "an admin replaces")
        # Bytes of a blob can never be poisoned, whoever writes them.
        equal(server.call("PUT", "/pr/7/cas/" + key(BLOB), b"evil", token=pull).status, 400, "wrong bytes")
        equal(server.get(BLOB, M, token=reader).status, 404, "and main has no such blob")


def token_file(binary):
    """A file that others could read, or that is wrong, starts no server; beyond loopback none starts without."""
    def starts(*words):
        with tempfile.TemporaryDirectory() as home:
            path = pathlib.Path(home) / "tokens"
            path.touch(mode=0o600)
            path.write_text("ci a-token-of-twenty-chars main:read\n")
            words = [w.replace("HOME", home) for w in words]
            for word in words:
                if word.startswith("mode="):
                    os.chmod(path, int(word[5:], 8))
                elif word.startswith("text="):
                    path.write_text(word[5:])
            words = [w for w in words if w.startswith("--")]
            done = subprocess.run([binary, "--check", f"--folder={home}/store", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=30)
            check(b"a-token-of" not in done.stderr, "an error repeats the token")
            return done.returncode
    tokens = "--tokens=HOME/tokens"
    equal(starts(tokens), 0, "positive control")
    for mode in ("640", "604", "660", "606", "644"):
        check(starts(tokens, "mode=" + mode) != 0, f"a token file of mode {mode}")
    for text in ("ci short main:read\n", "ci a-token-of-twenty-chars main:write\n", "ci a-token-of-twenty-chars\nci a-token-of-twenty-charz\n",
                 "ci\n", "ci a-token-of-twenty-chars mainread\n", "ci a-token-of-twenty-chars ../x:read\n", "ci sha256:00 main:read\n"):
        check(starts(tokens, "text=" + text) != 0, f"a token file with {text!r}")
    check(starts("--tokens=HOME/none") != 0, "a token file that is not there")
    check(starts("--tokens=HOME") != 0, "a folder as token file")
    for address in ("0.0.0.0:0", "[::]:0", "10.1.2.3:0"):
        check(starts("--listen=" + address) != 0, f"{address} without tokens")
    check(starts("--listen=0.0.0.0:0", tokens, "--plain_text=true") == 0, "positive control: every address with tokens")


def reload(binary):
    """SIGHUP takes new tokens; a file that is wrong keeps the old ones."""
    with served(binary) as server:
        path = server.home / "tokens"
        status = lambda token: server.call("GET", M + "/cas/" + key(b""), token=token).status
        fresh = "a-fresh-token-of-the-reader"

        def reloaded(text):
            path.write_text(text)
            lines = server.log().count('"reloaded"')
            server.process.send_signal(signal.SIGHUP)
            for _ in range(1000):
                if server.log().count('"reloaded"') > lines:
                    return
                server.call("GET", "/healthz")
            check(False, "SIGHUP did nothing")

        equal((status(SECRETS["reader"]), status(fresh)), (200, 401), "before")
        reloaded(f"reader {fresh} main:read\n")
        equal((status(SECRETS["reader"]), status(fresh)), (401, 200), "after")
        reloaded("nonsense\n")
        equal((status(SECRETS["reader"]), status(fresh)), (401, 200), "after a wrong file")


def anonymous(binary):
    with served(binary, anonymous="read") as server:
        equal(server.call("PUT", M + "/cas/" + key(BLOB), BLOB, token=SECRETS["writer"]).status, 201, "positive control")
        equal(server.get(BLOB, M).body, BLOB, "anybody reads")
        equal(server.put(BLOB, M), 401, "nobody writes without a token")
        equal(server.get(BLOB, M, token="a-token-that-nobody-has").status, 401, "a wrong token is no none")


if __name__ == "__main__":
    main([every_verb, refused_early, pull_requests, token_file, reload, anonymous])
