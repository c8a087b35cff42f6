#!/usr/bin/env python3
"""kiln build against a server that lies. Every attack costs time at most: the table is the one that is built alone, the build
succeeds with one warning, and nothing leaves for another host. The control of each is the same server being honest."""
import concurrent.futures
import hashlib
import os
import pathlib
import socket
import struct
import subprocess
import sys
import threading
import time
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from peers import build, check, in_folder, same

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "server"))
from protobuf_wire import field, varint

TOKEN = "tok-3141592653"


class Hostile:
    """Speaks HTTP by hand, so that it can do so wrongly."""

    def __init__(self):
        self.kept, self.attack, self.seen = {}, None, []
        self.listener = socket.create_server(("127.0.0.1", 0), backlog=64)
        self.port = self.listener.getsockname()[1]
        self.url = f"http://127.0.0.1:{self.port}"
        self.stopped = threading.Event()
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            connection, _ = self.listener.accept()
            threading.Thread(target=self.serve, args=(connection,), daemon=True).start()

    def serve(self, connection):
        try:
            with connection:
                stream = connection.makefile("rb")
                while self.one(connection, stream):
                    pass
        except OSError:
            pass

    def one(self, connection, stream):
        line = stream.readline().decode("latin-1").split()
        if len(line) != 3:
            return False
        method, path, _ = line
        headers = {}
        while (field := stream.readline().strip()):
            name, _, value = field.decode("latin-1").partition(":")
            headers[name.lower()] = value.strip()
        body = stream.read(int(headers.get("content-length", "0")))
        self.seen.append((method, path, headers.get("authorization", "")))
        return (self.attack or honest)(self, connection, method, path, body)


def reply(connection, status, body=b"", head="", length=None):
    text = f"HTTP/1.1 {status} x\r\nContent-Length: {len(body) if length is None else length}\r\n{head}\r\n"
    connection.sendall(text.encode() + body)
    return True


def honest(server, connection, method, path, body):
    if method == "PUT":
        server.kept[path] = body
        return reply(connection, 201)
    if path not in server.kept:
        return reply(connection, 404, b"" if method == "HEAD" else b"not here")
    return reply(connection, 200, b"" if method == "HEAD" else server.kept[path], length=len(server.kept[path]))


def on_get(answer):
    """An attack on what is read; writes and questions are answered honestly, a GET of what is not there too."""
    def attack(server, connection, method, path, body):
        if method != "GET" or path not in server.kept:
            return honest(server, connection, method, path, body)
        return answer(server, connection, path, server.kept[path])
    return attack


def wait(seconds=4):
    time.sleep(seconds)
    return False


def forever(connection, piece, pause=0.0, most=20):
    end = time.monotonic() + most
    while time.monotonic() < end:
        connection.sendall(piece)
        time.sleep(pause)
    return False


def start(connection, head):
    connection.sendall(b"HTTP/1.1 200 OK\r\n" + head + b"\r\n")


def with_path(value, path):
    """An ActionResult that also names an output file of the given path."""
    digest = field(1, hashlib.sha256(b"x").hexdigest().encode()) + b"\x10\x01"
    return value + field(2, field(1, path) + field(2, digest))


def other(server, path, own):
    """Another entry of the same keyspace."""
    folder = path.rsplit("/", 1)[0]
    return next(v for p, v in sorted(server.kept.items()) if p.rsplit("/", 1)[0] == folder and p != path and v != own)


def memo_of(path, names):
    """An action's value as kiln writes it: this build depends on files of these names, what do they hold?"""
    record = b"\0" + struct.pack("<Q", len(names)) + b"".join(struct.pack("<Q", len(n)) + n for n in names)
    return field(5, b"kilnrec1" + bytes.fromhex(path[-64:]) + struct.pack("<Q", len(record)) + record + struct.pack("<Q", 0))


def memo_attack(*names):
    return on_get(lambda s, c, p, v: reply(c, 200, memo_of(p, [n() for n in names]) if "/ac/" in p else v))


def large_records(size):
    """Every record is elsewhere, in a blob of this size that nobody ever hashes to its name."""
    named = set()

    def attack(server, connection, method, path, body):
        if method == "GET" and "/ac/" in path:
            name = hashlib.sha256(path.encode()).hexdigest()
            named.add(name)
            return reply(connection, 200, field(2, field(1, b"record") + field(2, field(1, name.encode()) + b"\x10" + varint(size))))
        if method == "GET" and path[-64:] in named:
            return reply(connection, 200, bytes(size))
        return honest(server, connection, method, path, body)
    return attack


bomb = zlib.compressobj(9, zlib.DEFLATED, 31)
BOMB = bomb.compress(bytes(64 << 20)) + bomb.flush()

ATTACKS = {
    "other bytes": on_get(lambda s, c, p, v: reply(c, 200, other(s, p, v))),
    "a flipped bit": on_get(lambda s, c, p, v: reply(c, 200, v[:-1] + bytes([v[-1] ^ 1]))),
    "nothing": on_get(lambda s, c, p, v: reply(c, 200, b"")),
    "a page": on_get(lambda s, c, p, v: reply(c, 200, b"<html>please log in</html>")),
    "silence": lambda s, c, m, p, b: wait(),
    "silence within a body": on_get(lambda s, c, p, v: (start(c, b"Content-Length: 100000\r\n"), c.sendall(v[:10]), wait())[2]),
    "an endless body": on_get(lambda s, c, p, v: (start(c, b""), forever(c, b"x" * 65536))[1]),
    "an endless chunked body": on_get(lambda s, c, p, v: (start(c, b"Transfer-Encoding: chunked\r\n"), forever(c, b"8000\r\n" + b"y" * 32768 + b"\r\n"))[1]),
    "endless headers": on_get(lambda s, c, p, v: (c.sendall(b"HTTP/1.1 200 OK\r\n"), forever(c, b"X-A: " + b"z" * 1000 + b"\r\n"))[1]),
    "an endless header": on_get(lambda s, c, p, v: (c.sendall(b"HTTP/1.1 200 OK\r\nX-A: "), forever(c, b"z" * 4096))[1]),
    "endless interim answers": on_get(lambda s, c, p, v: forever(c, b"HTTP/1.1 100 Continue\r\n\r\n")),
    "a byte at a time": on_get(lambda s, c, p, v: (start(c, b"Content-Length: 5000\r\n"), forever(c, b"x", 0.05, 8))[1]),
    "an endless 404": lambda s, c, m, p, b: honest(s, c, m, p, b) if m != "GET" else (
        c.sendall(b"HTTP/1.1 404 x\r\n\r\n"), forever(c, b"x" * 65536))[1],
    "a redirect elsewhere": on_get(lambda s, c, p, v: reply(c, 302, b"", f"Location: {s.trap.url}{p}\r\n")),
    "a redirect to a file": on_get(lambda s, c, p, v: reply(c, 301, b"", "Location: file:///etc/passwd\r\n")),
    "a redirect to itself": on_get(lambda s, c, p, v: reply(c, 307, b"", f"Location: {s.url}{p}\r\n")),
    "garbage": lambda s, c, m, p, b: (c.sendall(bytes(range(256)) * 4), False)[1],
    "an old protocol": on_get(lambda s, c, p, v: (c.sendall(v), False)[1]),
    "closing at once": lambda s, c, m, p, b: False,
    "500": lambda s, c, m, p, b: reply(c, 500, b"oh"),
    "503 now and then": lambda s, c, m, p, b: reply(c, 503) if len(s.seen) % 3 else honest(s, c, m, p, b),
    "206": on_get(lambda s, c, p, v: reply(c, 206, v, "Content-Range: bytes 0-1/2\r\n")),
    "a bomb": on_get(lambda s, c, p, v: reply(c, 200, BOMB, "Content-Encoding: gzip\r\n")),
    "a body cut short": on_get(lambda s, c, p, v: (reply(c, 200, v[:-1], length=len(v)), False)[1]),
    "a huge length": on_get(lambda s, c, p, v: (reply(c, 200, v, length=1 << 62), False)[1]),
    "a negative length": on_get(lambda s, c, p, v: (reply(c, 200, v, length=-5), False)[1]),
    "two lengths": on_get(lambda s, c, p, v: reply(c, 200, v, f"Content-Length: {len(v) + 7}\r\n")),
    "length and chunks": on_get(lambda s, c, p, v: (reply(c, 200, b"ffffffffffffffff\r\nx\r\n", "Transfer-Encoding: chunked\r\n"), False)[1]),
    "a path upwards": on_get(lambda s, c, p, v: reply(c, 200, with_path(v, b"../../etc/cron.d/x") if "/ac/" in p else v)),
    "an absolute path": on_get(lambda s, c, p, v: reply(c, 200, with_path(v, b"/etc/cron.d/x") if "/ac/" in p else v)),
    "a deep message": on_get(lambda s, c, p, v: reply(c, 200, b"\x12" * 100000 if "/ac/" in p else v)),
    "a huge action": on_get(lambda s, c, p, v: reply(c, 200, v + field(99, bytes(3 << 20)) if "/ac/" in p else v)),
    "records of 15 MiB": large_records(15 << 20),
    "records of 1 GiB": large_records(1 << 30),
    "a huge blob's name": on_get(lambda s, c, p, v: reply(
        c, 200, v.replace(b"\x10", b"\x10\xff\xff\xff\xff\xff\xff\xff\x3f", 1) if "/ac/" in p else v)),
    "a build of a device": memo_attack(lambda: b"/dev/zero"),
    "a build of a pipe": memo_attack(lambda: os.path.abspath("pipe").encode()),
    "a build of many files": memo_attack(*[lambda: os.urandom(8).hex().encode()] * 50000),
    "a build without end": memo_attack(lambda: os.urandom(8).hex().encode()),
    "a build of a name with a NUL": memo_attack(lambda: b"p/paint.frag\0.glsl"),
    "writes refused": lambda s, c, m, p, b: reply(c, 507) if m == "PUT" else honest(s, c, m, p, b),
    "writes lost": lambda s, c, m, p, b: reply(c, 201) if m == "PUT" else honest(s, c, m, p, b),
    "everything is there": lambda s, c, m, p, b: reply(c, 200, length=7) if m == "HEAD" else honest(s, c, m, p, b),
}
# What a build does not notice, since nothing that it read was wrong.
UNNOTICED = {"writes lost", "everything is there", "an endless 404", "a huge blob's name",
             "a build of a device", "a build of a pipe", "a build of many files", "a build without end", "a build of a name with a NUL"}


def attacked(number, name, kept, trap):
    server, attack, out = Hostile(), ATTACKS[name], f"t{number}.kiln"
    server.trap = trap
    for project in ("p", "q"):
        table = f"alone{'_q' if project == 'q' else ''}.kiln"
        server.attack, server.kept = None, dict(kept)
        control = build(f"{project}/m.yaml", out, "--cache", "none", "--cache", server.url, "--cache-read-only", KILN_CACHE_TOKEN=TOKEN)
        check(control.remote["hits"] > 2 and control.json["work"]["compiled"] == 0 and control.err == "",
              f"{name}: the control is no hit: {control.remote} {control.err}")
        server.attack, server.seen = attack, []
        hurt = build(f"{project}/m.yaml", out, "--cache", "none", "--cache", server.url, KILN_CACHE_TOKEN=TOKEN,
                     KILN_CACHE_TIMEOUT="0.3", KILN_CACHE_DRAIN="2")
        same(table, out, name)
        check(hurt.err.count("warning") <= 1, f"{name}: more than one warning: {hurt.err}")
        check(TOKEN not in hurt.err + hurt.out, f"{name}: the token was printed")
        check(hurt.json["bytes"]["peak_memory"] < 400 << 20, f"{name}: took {hurt.json['bytes']['peak_memory']} bytes")
        check(server.seen and all(a == f"Bearer {TOKEN}" for _, _, a in server.seen), f"{name}: a request without the token")
        remote = hurt.remote
        noticed = remote["failures"] + remote["corrupt"] > 0
        check(noticed or name in UNNOTICED or project == "p" and name.startswith("writes"), f"{name}, {project}: nobody noticed: {remote}")
        check(not noticed or hurt.err.count("warning") == 1, f"{name}: no warning: {hurt.err}")


def main():
    server, trap = Hostile(), Hostile()
    os.mkfifo("pipe")
    build("p/m.yaml", "alone.kiln", "--cache", "none")
    first = build("p/m.yaml", "first.kiln", "--cache", "none", "--cache", server.url, KILN_CACHE_TOKEN=TOKEN)
    same("alone.kiln", "first.kiln", "honest")
    check(first.remote["sent"] > 10, "the server was not filled")
    kept = dict(server.kept)
    pathlib.Path("q/lib").mkdir(parents=True)
    for name in ("m.yaml", "lib/tint.glsl"):
        pathlib.Path("q", name).write_text(pathlib.Path("p", name).read_text())
    pathlib.Path("q/paint.frag").write_text(pathlib.Path("p/paint.frag").read_text() + "// a remark: its classes are asked for one by one\n")
    build("q/m.yaml", "alone_q.kiln", "--cache", "none")

    # Most of them only wait, so several go at once, each against a server of its own.
    with concurrent.futures.ThreadPoolExecutor(6) as pool:
        for done in [pool.submit(attacked, i, name, kept, trap) for i, name in enumerate(ATTACKS)]:
            done.result()
    check(trap.seen == [], f"something was sent to another host: {trap.seen}")

    # What goes to this machine in clear text is not shown to a proxy, as a proxy for all would have it.
    server.kept, server.attack = dict(kept), None
    for name in ("http_proxy", "all_proxy"):
        direct = build("p/m.yaml", "t.kiln", "--cache", "none", "--cache", server.url, KILN_CACHE_TOKEN=TOKEN, **{name: trap.url})
        check(direct.remote["hits"] > 2 and trap.seen == [], f"{name} was asked: {trap.seen} {direct.err}")
        subprocess.run(["curl", "-s", "-o", "curl.out", server.url], env={**os.environ, name: trap.url}, timeout=20)
        check(trap.seen != [], f"the control: curl did not ask {name}")
        trap.seen.clear()

    # A token that may read only, and one that may do nothing.
    server.kept = dict(kept)
    server.attack = lambda s, c, m, p, b: reply(c, 403) if m == "PUT" else honest(s, c, m, p, b)
    pathlib.Path("q/paint.frag").write_text(pathlib.Path("p/paint.frag").read_text().replace("0.5", "0.75"))
    build("q/m.yaml", "alone_q.kiln", "--cache", "none")
    reader = build("q/m.yaml", "t.kiln", "--cache", "none", "--cache", server.url, KILN_CACHE_TOKEN=TOKEN)
    same("alone_q.kiln", "t.kiln", "a reader")
    check("warning" not in reader.err and "read only" in reader.err, f"a reader is told: {reader.err}")
    check(reader.remote["sent"] == 0 and server.kept == kept, "a reader wrote")
    server.attack, server.seen = lambda s, c, m, p, b: reply(c, 401), []
    nobody = build("p/m.yaml", "t.kiln", "--cache", "none", "--cache", server.url, KILN_CACHE_TOKEN=TOKEN)
    same("alone.kiln", "t.kiln", "nobody")
    check(nobody.err.count("warning") == 1 and "may not read" in nobody.err and len(server.seen) <= 20, f"nobody: {nobody.err} {len(server.seen)}")


in_folder(main)
print(f"hostile: {len(ATTACKS)} attacks, ok")
