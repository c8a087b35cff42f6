#!/usr/bin/env python3
"""Requests that no client means: each is refused, ends its connection where its end is in doubt, and leaves the server as it was.

usage: malformed_test.py KILN_CACHED [TEST...]
"""
import hashlib
import random

from cached import Cached, check, equal, key, main, statuses

BLOB = b"a blob that is there"
NAME = key(BLOB)
SMUGGLED = b"GET /healthz HTTP/1.1\r\nHost: h\r\n\r\n"


def request(method="GET", target="/cas/" + NAME, version="HTTP/1.1", headers=("Host: h",), body=b"", end="\r\n\r\n"):
    return (f"{method} {target} {version}\r\n" + "\r\n".join(headers) + end).encode("latin1") + body


def heads(binary):
    """Each malformed head gets one answer of its class and no second one for what stands behind it."""
    large = "x" * 20_000
    put = f"/cas/{NAME}"
    n = len(BLOB)
    bad = {
        "not HTTP": b"hello\r\n\r\n",
        "TLS hello": b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(64),
        "HTTP/2 preface": b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
        "HTTP/0.9": b"GET /healthz\r\n\r\n",
        "HTTP/3.0": request(version="HTTP/3.0"),
        "HTTP/1.2": request(version="HTTP/1.2"),
        "lower-case http": request(version="http/1.1"),
        "two spaces": b"GET  /healthz HTTP/1.1\r\nHost: h\r\n\r\n",
        "tab for space": b"GET\t/healthz HTTP/1.1\r\nHost: h\r\n\r\n",
        "bare LF": b"GET /healthz HTTP/1.1\nHost: h\n\n",
        "bare CR": b"GET /healthz HTTP/1.1\rHost: h\r\n\r\n",
        "NUL in the target": b"GET /cas/\0 HTTP/1.1\r\nHost: h\r\n\r\n",
        "NUL in a value": b"GET /healthz HTTP/1.1\r\nHost: h\r\nX: a\0b\r\n\r\n",
        "space before the colon": b"GET /healthz HTTP/1.1\r\nHost : h\r\n\r\n",
        "folded line": request("PUT", put, headers=("Host: h", "Transfer-Encoding:", " chunked"), body=b"0\r\n\r\n"),
        "folded by a tab": request(headers=("Host: h", "X: a", "\tb")),
        "no colon": b"GET /healthz HTTP/1.1\r\nHost: h\r\nnonsense\r\n\r\n",
        "no Host": request(headers=("X: y",)),
        "two Hosts": request(headers=("Host: a", "Host: b")),
        "method with a bracket": request(method="G(T"),
        "two lengths": request("PUT", put, headers=("Host: h", f"Content-Length: {n}", "Content-Length: 5"), body=BLOB),
        "one length twice": request("PUT", put, headers=("Host: h", f"Content-Length: {n}", f"Content-Length: {n}"), body=BLOB),
        "list of lengths": request("PUT", put, headers=("Host: h", f"Content-Length: {n}, {n}"), body=BLOB),
        "negative length": request("PUT", put, headers=("Host: h", "Content-Length: -1"), body=BLOB),
        "signed length": request("PUT", put, headers=("Host: h", f"Content-Length: +{n}"), body=BLOB),
        "hex length": request("PUT", put, headers=("Host: h", "Content-Length: 0x14"), body=BLOB),
        "empty length": request("PUT", put, headers=("Host: h", "Content-Length:"), body=BLOB),
        "length past 64 bits": request("PUT", put, headers=("Host: h", "Content-Length: 18446744073709551636"), body=BLOB),
        "length and chunks": request("PUT", put, headers=("Host: h", f"Content-Length: {n}", "Transfer-Encoding: chunked"), body=b"0\r\n\r\n"),
        "chunks and length": request("PUT", put, headers=("Host: h", "Transfer-Encoding: chunked", f"Content-Length: {n}"), body=b"0\r\n\r\n"),
        "chunked twice": request("PUT", put, headers=("Host: h", "Transfer-Encoding: chunked", "Transfer-Encoding: chunked"), body=b"0\r\n\r\n"),
        "gzip, chunked": request("PUT", put, headers=("Host: h", "Transfer-Encoding: gzip, chunked"), body=b"0\r\n\r\n"),
        "identity": request("PUT", put, headers=("Host: h", "Transfer-Encoding: identity"), body=BLOB),
        "xchunked": request("PUT", put, headers=("Host: h", "Transfer-Encoding: xchunked"), body=b"0\r\n\r\n"),
        "chunked in HTTP/1.0": request("PUT", put, "HTTP/1.0", headers=("Host: h", "Transfer-Encoding: chunked"), body=b"0\r\n\r\n"),
        "two Authorizations": request(headers=("Host: h", "Authorization: Bearer a", "Authorization: Bearer b")),
        "large field": request(headers=("Host: h", "X: " + large)),
        "large target": request(target="/" + large),
        "many fields": request(headers=["Host: h"] + [f"X{i}: y" for i in range(3000)]),
        "unknown expectation": request("PUT", put, headers=("Host: h", "Expect: a-miracle", f"Content-Length: {n}"), body=BLOB),
    }
    with Cached(binary) as server:
        equal(server.put(BLOB), 201, "positive control: PUT")
        good = request(headers=("Host: h", "Connection: close"))
        equal(statuses(server.raw(good)), [200], "positive control: the same request, whole")
        equal(statuses(server.raw(SMUGGLED + good)), [200, 200], "positive control: two requests at once")
        for name, data in bad.items():
            got = statuses(server.raw(data + SMUGGLED))
            check(got is not None and len(got) == 1 and got[0] in (400, 411, 413, 417, 431, 501, 505), f"{name}: {got}")
        equal(server.get(BLOB).body, BLOB, "the blob after all that")
        metrics = server.call("GET", "/metrics").body.decode()
        check("kiln" in metrics, "the server still answers")


def targets(binary):
    """Names that lead elsewhere are nothing, and nothing appears on the disk."""
    up = NAME.upper()
    with Cached(binary, instances=["name: main", "name: pr/*, parent: main"]) as server:
        equal(server.put(BLOB), 201, "positive control")
        before = sorted(p for p in server.home.rglob("*") if p.is_file() and p != server.log_path and "index" not in p.parts)
        for target in (f"/cas/{up}", f"/cas/{NAME[1:]}", f"/cas/{NAME}0", f"/cas/../cas/{NAME}", f"/cas/%2e%2e/{NAME}", f"/cas/..%2f{NAME}",
                       f"//cas/{NAME}", f"/cas//{NAME}", f"/./cas/{NAME}", f"/cas/{NAME}?x=1", f"/cas/{NAME}#x", f"/cas/{NAME}/",
                       f"/cas\\{NAME}", f"http://h/cas/{NAME}", f"/cas/{NAME};x", f"/%63as/{NAME}", f"/cas/{NAME[:62]}%30%30",
                       "/cas/../../../../etc/passwd", "/dav/../../etc/passwd", "/dav/%2e%2e/x", "/dav/a//b", "/dav/./a", f"/pr/../cas/{NAME}",
                       f"/pr/%2e%2e/cas/{NAME}", f"/ac/{NAME}\xc3\xa9", "*", "/cas", "/cas/", "/ac/" + "a" * 5000, "/blobs/" + NAME, f"/cas/ac/{NAME}",
                       f"/{'i/' * 40}cas/{NAME}", f"/{'i' * 200}/cas/{NAME}"):
            for method in ("GET", "PUT"):
                headers = ["Host: h", "Connection: close"] + ([f"Content-Length: {len(BLOB)}"] if method == "PUT" else [])
                got = statuses(server.raw(request(method, target, headers=headers, body=BLOB if method == "PUT" else b"")))
                check(got is not None and len(got) == 1 and 400 <= got[0] < 500, f"{method} {target[:80]}: {got}")
        after = sorted(p for p in server.home.rglob("*") if p.is_file() and p != server.log_path and "index" not in p.parts)
        equal(after, before, "files below the server's folder")


def methods(binary):
    with Cached(binary) as server:
        equal(server.put(BLOB), 201, "positive control")
        for method in ("POST", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT", "PROPFIND", "MKCOL", "COPY", "MOVE", "LOCK", "FOO", "get"):
            got = statuses(server.raw(request(method, headers=("Host: h", "Connection: close"))))
            check(got in ([405], [400]), f"{method} of a blob: {got}")
        for path in ("/status", "/metrics", "/healthz"):
            equal(server.call("PUT", path, b"x").status, 405, "PUT " + path)
            equal(server.call("GET", path).status, 200, "GET " + path)
        equal(server.call("DELETE", "/dav/x").status, 405, "DELETE below /dav")
        head = server.call("HEAD", "/cas/" + NAME)
        equal((head.status, head.headers["Content-Length"], head.body), (200, str(len(BLOB)), b""), "HEAD")
        equal(server.get(BLOB).body, BLOB, "the blob after all that")


def bodies(binary):
    """Bodies that are cut short, wrong, or never end: nothing of them is ever visible."""
    wanted = b"x" * 100_000
    name = key(wanted)
    head = f"PUT /cas/{name} HTTP/1.1\r\nHost: h\r\n".encode()
    with Cached(binary, limits_blob="1MiB") as server:
        for cut in (0, 1, 5000, 99_999):
            server.raw(head + b"Content-Length: 100000\r\n\r\n" + wanted[:cut], shut=True)
        for chunks in (b"", b"5\r\nxx", b"5\r\nxxxxx\r\n", b"5\r\nxxxxx\r\n0\r\n", b"g\r\n", b"-5\r\nxxxxx\r\n0\r\n\r\n", b"5;" + b"a" * 100_000,
                       b"ffffffffffffffff\r\nx", b"10000000000000000\r\nx", b"5\r\nxxxxxyy0\r\n\r\n", b"0x5\r\nxxxxx\r\n0\r\n\r\n"):
            got = statuses(server.raw(head + b"Transfer-Encoding: chunked\r\n\r\n" + chunks, shut=True))
            check(got == [] or (len(got) == 1 and 400 <= got[0] < 500), f"chunks {chunks[:30]}: {got}")
        equal(server.call("GET", "/cas/" + name).status, 404, "a blob that never came whole")
        # Too large: told at once when announced, at the limit when not.
        got = statuses(server.raw(head + b"Content-Length: 99999999999\r\n\r\n"))
        equal(got, [413], "a length over the limit")
        chunk = b"10000\r\n" + b"y" * 65536 + b"\r\n"
        got = statuses(server.raw(head + b"Transfer-Encoding: chunked\r\n\r\n" + chunk * 64))
        equal(got, [413], "chunks without end")
        equal(server.call("PUT", "/cas/" + name, b"x" * 99_999).status, 400, "a byte too few, wholly sent")
        equal(server.call("PUT", "/cas/" + name, b"x" * 100_001).status, 400, "a byte too many")
        equal(server.call("PUT", "/cas/" + name, b"y" + wanted[1:]).status, 400, "other bytes of the same length")
        equal(server.call("GET", "/cas/" + name).status, 404, "a blob that never came right")
        equal(server.call("PUT", "/ac/" + name, b"no ActionResult").status, 400, "an action that is none")
        equal(statuses(server.raw(b"PUT /cas/" + name.encode() + b" HTTP/1.1\r\nHost: h\r\n\r\n")), [411], "no length")
        equal([p for p in (server.folder / "tmp").glob("*")] if (server.folder / "tmp").exists() else [], [], "temporary files")
        got = server.raw(head + b"Transfer-Encoding: chunked\r\nConnection: close\r\n\r\n" + b"186a0\r\n" + wanted + b"\r\n0\r\n\r\n")
        equal(statuses(got), [201], "positive control: in chunks")
        equal(server.get(wanted).body, wanted, "positive control")


def compressed(binary):
    """zstd: right, bombs, rubbish."""
    import subprocess

    def zstd(data):
        return subprocess.run(["zstd", "-q", "-c", "-19"], input=data, stdout=subprocess.PIPE, check=True).stdout

    plain = b"the same words again and again " * 3000
    packed = zstd(plain)
    with Cached(binary, limits_blob="1MiB", limits_in_flight="4MiB") as server:
        put = lambda data, body, coding="zstd": server.call("PUT", "/cas/" + key(data), body, Content_Encoding=coding).status
        bomb = b"\0" * 200_000_000
        equal(put(bomb, zstd(bomb)), 413, "a bomb of 200 MB in a few KB")
        check(server.memory() < 100 << 20, f"memory after the bomb: {server.memory() >> 20} MiB")
        long_window = subprocess.run(["zstd", "-q", "-c", "--ultra", "-22", "--long=31"], input=plain, stdout=subprocess.PIPE, check=True).stdout
        check(put(plain, packed[:-5]) == 400, "cut short")
        equal(put(plain, packed + b"\0"), 400, "a byte behind")
        equal(put(plain, plain), 400, "not zstd at all")
        equal(put(plain, b""), 400, "nothing")
        equal(put(b"other", packed), 400, "other bytes inside")
        equal(put(plain, packed, "gzip"), 415, "another coding")
        check(put(plain, long_window) in (400, 413), "a window of 2 GiB")
        check(put(plain, packed) in (200, 201), "positive control")
        got = server.call("GET", "/cas/" + key(plain))
        equal((got.body, got.headers.get("Content-Encoding")), (plain, None), "read plainly")
        got = server.call("GET", "/cas/" + key(plain), Accept_Encoding="gzip, zstd")
        equal(got.headers.get("Content-Encoding"), "zstd", "read as zstd")
        unpacked = subprocess.run(["zstd", "-q", "-dc"], input=got.body, stdout=subprocess.PIPE, check=True).stdout
        equal(unpacked, plain, "what zstd(1) makes of it")
        equal(server.call("GET", "/cas/" + key(plain), Accept_Encoding="zstd;q=0").body, plain, "refused by weight")


def no_pool(binary):
    """Without a pool of threads the same requests get the same answers."""
    with Cached(binary, threads_work=0) as server:
        large = random.Random(7).randbytes(3_000_000)
        for blob in (BLOB, large):
            equal(server.get(blob).status, 404, "nothing yet")
            equal(server.put(blob), 201, "PUT")
            equal(server.put(blob), 200, "PUT again")
            equal(server.get(blob).body, blob, "GET")
        equal(server.call("PUT", "/cas/" + NAME, b"other").status, 400, "wrong bytes")
        for page in ("/status", "/metrics"):
            equal(server.call("GET", page).status, 200, page)
        good = request(headers=("Host: h", "Connection: close"))
        equal(statuses(server.raw(request() * 200 + good)), [200] * 201, "many requests at once")


def noise(binary):
    """Mutations of good requests, seeded: whatever comes back is HTTP, and the server lives."""
    random.seed(4)
    good = [request(), request("PUT", headers=("Host: h", f"Content-Length: {len(BLOB)}"), body=BLOB),
            request("PUT", headers=("Host: h", "Transfer-Encoding: chunked"), body=b"14\r\n" + BLOB + b"\r\n0\r\n\r\n"),
            request("PROPFIND", "/dav/a/", headers=("Host: h", "Depth: 1"))]
    with Cached(binary) as server:
        equal(server.put(BLOB), 201, "positive control")
        for i in range(400):
            data = bytearray(random.choice(good))
            for _ in range(random.randint(1, 4)):
                at = random.randrange(len(data))
                what = random.randrange(4)
                if what == 0:
                    data[at] = random.randrange(256)
                elif what == 1:
                    del data[at:at + random.randint(1, 8)]
                elif what == 2:
                    data[at:at] = bytes(random.randrange(256) for _ in range(random.randint(1, 8)))
                else:
                    data[at:at] = data[:random.randrange(40)]
                if not data:
                    data = bytearray(b"\0")
            got = server.raw(bytes(data), shut=True)
            check(statuses(got) is not None, f"round {i}: {bytes(data)[:80]!r} gave {got[:80]!r}")
        blobs = [p for p in (server.folder / "blob").rglob("*") if p.is_file()]
        for path in blobs:
            equal(hashlib.sha256(path.read_bytes()).hexdigest(), path.name, "a stored blob's name")
        equal(server.get(BLOB).body, BLOB, "the blob after all that")


if __name__ == "__main__":
    main([heads, targets, methods, bodies, compressed, no_pool, noise])
