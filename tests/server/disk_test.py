#!/usr/bin/env python3
"""Disks that are full, read-only, damaged, and too few files: refused with the right code, served again afterwards, never wrong.

usage: disk_test.py KILN_CACHED [TEST...]. A full and a read-only disk need mount(8), hence root; SKIP without.
"""
import os
import pathlib
import random
import contextlib
import http.client
import resource
import select
import subprocess
import tempfile
import threading

from cached import Cached, SKIP, check, equal, key, main, readable, statuses

skipped = []


class Mounted:
    """A tmpfs of its own."""

    def __init__(self, size):
        self.path = pathlib.Path(tempfile.mkdtemp(prefix="kiln-mount-"))
        self.size = size

    def __enter__(self):
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={self.size}", "tmpfs", str(self.path)], stderr=subprocess.PIPE)
        self.reason = done.stderr.decode().strip()
        self.mounted = done.returncode == 0
        return self

    def __exit__(self, *_):
        if self.mounted:
            subprocess.run(["umount", str(self.path)], check=False)
        self.path.rmdir()


def unmountable(mount, test):
    if mount.mounted:
        return False
    skipped.append(f"{test}: no tmpfs can be mounted: {mount.reason}")
    return True


def full(binary):
    """8 MiB of disk and a bound of 1 GiB: the disk is full long before the store is."""
    random.seed(1)
    blobs = [random.randbytes(700_000) for _ in range(16)]
    with Mounted("8m") as mount:
        if unmountable(mount, "full"):
            return
        with Cached(binary, folder=mount.path / "store", limit="1GiB") as server:
            codes = [server.put(blob) for blob in blobs]
            check(201 in codes, "positive control: nothing was stored")
            check(507 in codes, f"a full disk is not told: {codes}")
            check(set(codes) <= {200, 201, 507}, f"codes {codes}")
            for blob, code in zip(blobs, codes):
                got = server.get(blob)
                if code == 201:
                    equal((got.status, got.body == blob), (200, True), "a stored blob")
                else:
                    equal(got.status, 404, "a refused blob")
            equal(server.call("GET", "/healthz").status, 200, "/healthz")
            check("No space" in server.call("GET", "/status").body.decode(), "/status does not say why")
            check(str(mount.path).encode() not in b"".join(server.call("PUT", "/cas/" + key(b), b).body for b in blobs[-1:]),
                  "a client is told the server's paths")
            for path in list((server.folder / "blob").rglob("*"))[:6]:
                if path.is_file():
                    path.unlink()
            check(server.put(b"later") == 201, "nothing can be stored once there is room")


def bounded(binary):
    """A bound below what is written: the oldest go, the newest is there, the folder stays under its bound."""
    blobs = [i.to_bytes(4, "big") * 50_000 for i in range(40)]
    with Cached(binary, limit="2MiB") as server:
        for blob in blobs:
            equal(server.put(blob), 201, "PUT")
            equal(server.get(blob).body, blob, "what was just written")
        used = sum(p.stat().st_size for p in (server.folder / "blob").rglob("*") if p.is_file())
        check(used <= 2 << 20, f"{used} bytes in a store of 2 MiB")
        equal(server.get(blobs[0]).status, 404, "the oldest")
        equal(server.put(b"x" * (3 << 20)), 507, "a blob that never fits")
        equal(server.get(blobs[-1]).status, 200, "the newest, after one that never fits")


def read_only(binary):
    with Mounted("8m") as mount:
        if unmountable(mount, "read_only"):
            return
        with Cached(binary, folder=mount.path / "store") as server:
            equal(server.put(b"before"), 201, "positive control")
        equal(subprocess.run(["mount", "-o", "remount,ro", str(mount.path)]).returncode, 0, "remount")
        with Cached(binary, folder=mount.path / "store") as server:
            equal(server.get(b"before").body, b"before", "read from a read-only disk")
            equal(server.put(b"before"), 200, "what is there is there")
            equal(server.put(b"after"), 500, "written to a read-only disk")
            equal(server.get(b"after").status, 404, "what could not be written")
            equal(subprocess.run(["mount", "-o", "remount,rw", str(mount.path)]).returncode, 0, "remount")
            equal(server.put(b"after"), 201, "once it can be written again")


def few_files(binary):
    """64 descriptors: connections beyond what leaves the store its own are told so, the others are served."""
    blob = b"f" * 10_000
    few = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64))
    with Cached(binary, before=few) as server:
        equal(server.put(blob), 201, "positive control")
        held = [server.connect() for _ in range(80)]
        for s in held:
            s.sendall(f"GET /cas/{key(blob)} HTTP/1.1\r\nHost: h\r\n\r\n".encode())
        seen = {}
        for s in held:
            if readable(s, 0.05):
                codes = statuses(s.recv(65536)) or [None]
                seen[codes[0]] = seen.get(codes[0], 0) + 1
        check(set(seen) <= {200, 503} and seen[200] > 4, f"answers with few descriptors: {seen}")
        check(seen.get(200, 0) < 60, f"positive control: all were served: {seen}")
        for s in held:
            s.close()
        for _ in range(200):
            try:
                if server.get(blob).body == blob and server.put(b"more") in (200, 201):
                    break
            except OSError:
                pass
            threading.Event().wait(0.05)
        equal(server.get(blob).body, blob, "afterwards")
        equal(server.get(b"more").body, b"more", "afterwards")
        equal([p for p in (server.folder / "quarantine").rglob("*") if p.is_file()] if (server.folder / "quarantine").exists() else [], [],
              "a whole blob was set aside")


def soft_limit(binary):
    """A soft limit of descriptors far below the cap of connections: raised where it may be, else fewer connections are taken.
    Idle ones cost a connection that works nothing."""
    for hard in (20_000, 512):
        few = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (min(256, hard), hard))
        with Cached(binary, before=few) as server, contextlib.closing(http.client.HTTPConnection("127.0.0.1", server.port, timeout=20)) as kept:

            def call(method, blob):
                kept.request(method, "/cas/" + key(blob), blob if method == "PUT" else None)
                reply = kept.getresponse()
                reply.read()
                return reply.status

            large = b"l" * 100_000
            equal([call("PUT", large), call("GET", large)], [201, 200], "positive control")
            held = [server.connect() for _ in range(600)]
            closed = len(select.select(held, [], [], 20 if hard == 512 else 0.5)[0])  # those over the cap are told so
            taken = int([line.split()[-1] for line in server.log().splitlines() if '"started"' in line][0].split('"connections":')[1].split(",")[0])
            equal(taken, 4096 if hard == 20_000 else (512 - 256) // 2, "connections that are taken")
            check((closed > 0) == (hard == 512), f"{closed} of 600 were turned away below a hard limit of {hard}")
            for i in range(5):
                equal([call("GET", large), call("PUT", b"%d" % i), call("GET", b"%d" % i)], [200, 201, 200], f"among 600 idle ones, hard limit {hard}")
            for s in held:
                s.close()


def flipped(binary):
    """A bit changed on disk, in every kind of entry and at any age: never returned, and mended by the next PUT."""
    import time
    small, large = b"s" * 3000, b"l" * 3_000_000
    action, value = key(b"action"), b"\x2a\x02ok"
    with Cached(binary) as server:
        for trusted in (False, True):
            equal(server.call("PUT", "/ac/" + action, value).status in (200, 201), True, "PUT of an action")
            for blob in (small, large):
                check(server.put(blob) in (200, 201), "PUT")
                equal(server.get(blob).body, blob, "positive control")
                if trusted:
                    time.sleep(0.15)  # past the kernel's tick, so that the next read is not hashed
                    equal(server.get(blob).body, blob, "positive control")
                path = server.blob_path(key(blob))
                data = bytearray(path.read_bytes())
                data[len(data) // 2] ^= 4
                path.write_bytes(data)
                equal(server.get(blob).status, 404, f"a flipped bit in {len(blob)} bytes")
                check(not path.exists(), "it was not set aside")
                equal(server.put(blob), 201, "PUT again")
                equal(server.get(blob).body, blob, "mended")
            for path in (server.folder / "action").rglob("*"):
                if path.is_file():
                    data = bytearray(path.read_bytes())
                    data[-1] ^= 4
                    path.write_bytes(data)
            equal(server.call("GET", "/ac/" + action).status, 404, "a flipped bit in an action")
        check("damaged" in server.call("GET", "/metrics").body.decode() or "corrupt" in server.call("GET", "/metrics").body.decode(),
              "metrics do not count damage")


def crowd(binary):
    """24 writers and 8 readers of a few keys: a reader sees the whole blob or none; of differing actions the first stays."""
    blobs = [bytes([i]) * (1000 + 70_000 * (i % 3)) for i in range(6)]
    action = key(b"crowded")
    wrong, first = [], []
    with Cached(binary) as server:
        done = threading.Event()

        def reads():
            seen = None
            while not done.is_set():
                for blob in blobs:
                    got = server.get(blob)
                    if got.status not in (200, 404) or (got.status == 200 and got.body != blob):
                        wrong.append(f"{got.status} with {len(got.body)} bytes")
                got = server.call("GET", "/ac/" + action)
                if got.status == 200:
                    if seen not in (None, got.body):
                        wrong.append("an action changed")
                    seen = got.body

        def writes(me):
            for blob in blobs:
                if (code := server.put(blob)) not in (200, 201):
                    wrong.append(f"PUT {code}")
            if server.call("PUT", "/ac/" + action, b"\x2a\x01" + bytes([65 + me])).status == 201:
                first.append(me)

        readers = [threading.Thread(target=reads) for _ in range(8)]
        writers = [threading.Thread(target=writes, args=(i,)) for i in range(24)]
        for t in readers + writers:
            t.start()
        for t in writers:
            t.join()
        done.set()
        for t in readers:
            t.join()
        equal(wrong, [], "wrong answers")
        equal(len(first), 1, "first writers of one action")
        equal(server.call("GET", "/ac/" + action).body[2:], bytes([65 + first[0]]), "the first writer's value")
        for blob in blobs:
            equal(server.get(blob).body, blob, "in the end")


def killed(binary):
    """kill -9 in the middle of writes, twenty times: what was acknowledged is there and whole, and nothing else is wrong."""
    random.seed(9)
    acknowledged = {}
    with tempfile.TemporaryDirectory() as home:
        for round_ in range(20):
            server = Cached(binary, folder=home + "/store")
            count = random.randint(1, 12)
            stop = threading.Event()

            def writes(who):
                i = 0
                while not stop.is_set():
                    blob = f"{round_} {who} {i} ".encode() * random.randint(1, 5000)
                    try:
                        if server.put(blob) == 201:
                            acknowledged[key(blob)] = blob
                    except (OSError, Exception):
                        return
                    i += 1

            before = len(acknowledged)
            threads = [threading.Thread(target=writes, args=(w,)) for w in range(3)]
            for t in threads:
                t.start()
            while len(acknowledged) - before < count and any(t.is_alive() for t in threads):
                threading.Event().wait(0.001)
            server.process.kill()
            server.process.wait()
            stop.set()
            for t in threads:
                t.join()
            subprocess.run(["rm", "-rf", str(server.home)], check=False)
        check(len(acknowledged) >= 40, f"positive control: {len(acknowledged)} acknowledged")
        with Cached(binary, folder=home + "/store") as server:
            for blob in acknowledged.values():
                equal(server.get(blob).body, blob, "an acknowledged blob")
            for path in (server.folder / "blob").rglob("*"):
                if path.is_file():
                    equal(key(path.read_bytes()), path.name, "a blob's name")


if __name__ == "__main__":
    try:
        main([full, bounded, read_only, few_files, soft_limit, flipped, crowd, killed])
    except SystemExit as end:
        for reason in skipped:
            print("SKIP: " + reason)
        raise SystemExit(SKIP if skipped and end.code == 0 else end.code)
