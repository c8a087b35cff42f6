#!/usr/bin/env python3
"""Clients that are slow, idle, many or gone, and the server's end: each costs no more than its connection and its deadline.

usage: slow_test.py KILN_CACHED [TEST...]. No test asserts how long something takes: it waits for what must happen.
"""
import signal
import socket
import threading

from cached import Cached, Failed, check, equal, key, main, readable, statuses

BLOB = b"b" * 50_000
PUT = f"PUT /cas/{key(BLOB)} HTTP/1.1\r\nHost: h\r\nContent-Length: {len(BLOB)}\r\n\r\n".encode()
GET = f"GET /cas/{key(BLOB)} HTTP/1.1\r\nHost: h\r\n\r\n".encode()


def ended(s, drip=None, seconds=20):
    """Whether the server ends the connection while the client drips."""
    for _ in range(int(seconds / 0.05)):
        if readable(s, 0.05):
            try:
                if not s.recv(65536):
                    return True
            except OSError:
                return True
        if drip:
            try:
                s.send(drip)
            except OSError:
                return True
    return False


def deadlines(binary):
    """Slow at the head, the body, reading, or doing nothing: ended by the deadline, while others are served."""
    short = {"timeouts_head": "500ms", "timeouts_body": "500ms", "timeouts_write": "500ms", "timeouts_idle": "500ms"}
    large = b"L" * (32 << 20)
    with Cached(binary, **short) as server:
        equal(server.put(BLOB), 201, "positive control")
        equal(server.put(large), 201, "positive control: 32 MiB")
        slow = {"head": server.connect(), "body": server.connect(), "idle": server.connect(), "second head": server.connect(),
                "reader": socket.socket()}
        slow["reader"].setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        slow["reader"].connect(("127.0.0.1", server.port))
        slow["head"].send(b"GET /cas/")
        slow["body"].send(PUT + b"b")
        slow["second head"].send(GET)
        slow["reader"].send(f"GET /cas/{key(large)} HTTP/1.1\r\nHost: h\r\n\r\n".encode())
        equal(server.get(BLOB).status, 200, "another client meanwhile")
        check(ended(slow["head"], b"a"), "a head a byte at a time goes on for ever")
        check(ended(slow["body"], b"b"), "a body a byte at a time goes on for ever")
        check(ended(slow["idle"]), "an idle connection stays for ever")
        check(ended(slow["second head"], None), "an idle connection stays for ever after its first request")
        # The reader reads nothing; once the server has given up, what the kernel held is all that ever comes.
        held = lambda: [line for line in server.call("GET", "/metrics").body.decode().splitlines() if "timeout" in line and line[0] != "#"]
        for _ in range(200):
            if float(held()[0].split()[-1]) >= 3:
                break
            readable(slow["reader"], 0)
            threading.Event().wait(0.05)
        got = 0
        while part := slow["reader"].recv(1 << 20):
            got += len(part)
        check(got < len(large), f"a client that did not read got all {got} bytes")
        for s in slow.values():
            s.close()
        equal(server.get(large).body, large, "a client that does read")


def caps(binary):
    """More connections than the cap: told so, and served again once there is room."""
    with Cached(binary, limits_connections=20) as server:
        equal(server.put(BLOB), 201, "positive control")
        held = [server.connect() for _ in range(20)]
        for s in held:  # each is known to be open
            s.sendall(GET)
            check(readable(s, 20), "a connection within the cap is not served")
        over = [server.raw(b"") for _ in range(5)]
        equal([statuses(o) for o in over], [[503]] * 5, "connections over the cap")
        for s in held:
            s.close()
        for _ in range(100):
            if statuses(server.raw(GET.replace(b"\r\n\r\n", b"\r\nConnection: close\r\n\r\n"))) == [200]:
                return
        raise Failed("no connection after the others had gone")


def announced_memory(binary):
    """A hundred clients announce 200 MiB each and send nothing: memory is taken for what comes, not for what is said."""
    with Cached(binary) as server:
        equal(server.put(BLOB), 201, "positive control")
        before = server.memory()
        head = b"PUT /cas/" + b"a" * 64 + b" HTTP/1.1\r\nHost: h\r\nContent-Length: 209715200\r\n\r\nsome"
        held = [server.connect() for _ in range(100)]
        for s in held:
            s.sendall(head)
        equal(server.get(BLOB).status, 200, "another client meanwhile")
        check(server.memory() - before < 40 << 20, f"memory grew by {(server.memory() - before) >> 20} MiB")
        for s in held:
            s.close()


def unwanted_bodies(binary):
    """What takes no body takes none, from anybody: it is refused at its head, by length or by chunks, and costs no memory."""
    token = "writers-token-of-this-test"
    lines = ("GET /healthz", "HEAD /healthz", "GET /", "GET /status", "GET /metrics", "OPTIONS /main/dav/", "GET /main/cas/" + key(BLOB), "MKCOL /main/dav/a/")
    with Cached(binary, instances=["name: main"], tokens=[f"ci {token} main:read,cas-write,ac-write"]) as server:
        for line in lines:
            for bearer in ("", f"Authorization: Bearer {token}\r\n"):
                before = server.memory()
                for field, first in (("Content-Length: 300000000", b"x"), ("Transfer-Encoding: chunked", b"fffffff\r\n")):
                    s = server.connect(20)
                    s.sendall(f"{line} HTTP/1.1\r\nHost: h\r\n{bearer}{field}\r\n\r\n".encode() + first)
                    try:
                        for _ in range(100):
                            s.sendall(bytes(1 << 20))
                    except OSError:
                        pass  # the connection was ended: as it should be
                    s.close()
                check(server.memory() - before < 20 << 20, f"{line}: a body took {(server.memory() - before) >> 20} MiB")
        # The control: where a body is wanted it is taken, and this is how it shows.
        before = server.memory()
        s = server.connect(20)
        s.sendall(f"PUT /main/cas/{key(BLOB)} HTTP/1.1\r\nHost: h\r\nAuthorization: Bearer {token}\r\nContent-Length: 200000000\r\n\r\n".encode())
        for _ in range(100):
            s.sendall(bytes(1 << 20))
        check(server.memory() - before > 50 << 20, "a wanted body does not show in memory: this test shows nothing")
        s.close()


def unread_records(binary):
    """Readers of a large record that read nothing: so many as fit into the memory for them, and no more; writers are served."""
    name, value = key(b"large"), bytes(30 << 20)
    with Cached(binary, instances=["name: cc, opaque: true"], limits_in_flight="64MiB") as server:
        equal(server.call("PUT", f"/cc/ac/{name}", value).status, 201, "positive control")
        held = []
        for _ in range(12):
            s = socket.socket()
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            s.connect(("127.0.0.1", server.port))
            s.sendall(f"GET /cc/ac/{name} HTTP/1.1\r\nHost: h\r\n\r\n".encode())
            held.append(s)
        answers = [s.recv(12) for s in held]
        equal(sorted(answers), [b"HTTP/1.1 200"] * 2 + [b"HTTP/1.1 503"] * 10, "twelve readers of 30 MiB within 64 MiB")
        check(server.memory() < 180 << 20, f"memory: {server.memory() >> 20} MiB")
        equal(server.put(BLOB), 201, "a writer meanwhile")
        for s in held:
            s.close()
        for _ in range(200):
            if server.call("GET", f"/cc/ac/{name}").status == 200:
                return
            threading.Event().wait(0.02)
        raise Failed("no reader once the others have gone")


def in_flight(binary):
    """Bodies beyond the server's memory for them are told 503, later ones are taken."""
    body = b"i" * 900_000
    with Cached(binary, limits_blob="1MiB", limits_in_flight="2MiB") as server:
        head = f"PUT /cas/{key(body)} HTTP/1.1\r\nHost: h\r\nContent-Length: {len(body)}\r\n\r\n".encode()
        held = []
        busy = False
        for _ in range(6):
            s = server.connect()
            s.sendall(head + body[:-1])
            held.append(s)
        for s in held:
            if readable(s, 1):
                busy |= statuses(s.recv(4096)) == [503]
        check(busy, "six bodies of 0.9 MB fit into 2 MiB")
        for s in held:
            s.close()
        for _ in range(200):
            if server.put(body) == 201:
                break
            threading.Event().wait(0.02)
        equal(server.get(body).body, body, "a body once the others have gone")


def goes_away(binary):
    """Clients that reset in the middle of everything."""
    with Cached(binary) as server:
        equal(server.put(BLOB), 201, "positive control")
        large = b"M" * (8 << 20)
        equal(server.put(large), 201, "positive control")
        for data in (b"", b"GE", GET, PUT[:30], PUT, PUT + BLOB[:100], PUT + BLOB, f"GET /cas/{key(large)} HTTP/1.1\r\nHost: h\r\n\r\n".encode()):
            for _ in range(20):
                s = server.connect()
                s.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
                s.send(data)
                s.close()
        equal(server.get(large).body, large, "another client afterwards")


def drains(binary):
    """SIGTERM: what is under way ends well, idle connections are closed, nothing new is taken, the exit code is 0."""
    with Cached(binary) as server:
        idle, busy = server.connect(), server.connect()
        idle.sendall(GET)
        check(readable(idle, 20), "no reply")
        idle.recv(65536)
        busy.sendall(PUT + BLOB[:1000])
        equal(server.get(BLOB).status, 404, "not yet there")  # by now the server has the beginning of the body
        server.process.send_signal(signal.SIGTERM)
        check(ended(idle), "an idle connection outlives SIGTERM")
        check(server.process.poll() is None, "the server did not wait for the body")
        busy.sendall(BLOB[1000:])
        check(statuses(busy.recv(65536)) == [201], "the request under way was cut")
        equal(server.process.wait(30), 0, "exit code")
        check(server.blob_path(key(BLOB)).read_bytes() == BLOB, "the blob is not on disk")


def trickles(binary):
    """A body that comes, and a reply that is read, in time for each piece but far too slowly as a whole."""
    large = bytes(24 << 20)
    head = f"PUT /cas/{'a' * 64} HTTP/1.1\r\nHost: h\r\nContent-Length: {len(large)}\r\n\r\n".encode()
    with Cached(binary, timeouts_patience="500ms", limits_slowest="24MiB") as strict, Cached(binary) as lenient:
        for server in (strict, lenient):
            equal(server.put(large), 201, "positive control: 24 MiB")
        writers = [server.connect() for server in (strict, lenient)]
        for s in writers:
            s.sendall(head)
        for _ in range(400):
            writers[1].sendall(bytes(70_000))
            if ended(writers[0], seconds=0.05):
                break
            try:
                writers[0].sendall(bytes(70_000))
            except OSError:
                break
        else:
            raise Failed("a body of 24 MiB in small pieces goes on for ever")
        check(not readable(writers[1], 0.1), "the control: without the setting this body would not have been ended")
        reader = socket.socket()
        reader.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        reader.connect(("127.0.0.1", strict.port))
        reader.sendall(f"GET /cas/{key(large)} HTTP/1.1\r\nHost: h\r\n\r\n".encode())
        got = 0
        ended_by_deadline = lambda: b"kiln_cached_http_timeouts_total 2" in strict.call("GET", "/metrics").body
        for _ in range(400):
            got += len(reader.recv(20_000))
            if ended_by_deadline():
                break
            threading.Event().wait(0.02)
        while part := reader.recv(1 << 20):
            got += len(part)
        check(got < len(large), f"a reader of 20 KB now and then got all {got} bytes")
        for s in (*writers, reader):
            s.close()


def drains_both(binary):
    """At SIGTERM both fronts stop taking connections at once, while HTTP still has a request under way."""
    with Cached(binary, grpc="127.0.0.1:0") as server:
        grpc = int(server.process.stdout.readline().decode().rsplit(":", 1)[1])
        busy = server.connect()
        busy.sendall(PUT + BLOB[:1000])
        equal(server.get(BLOB).status, 404, "not yet there")
        socket.create_connection(("127.0.0.1", grpc), 20).close()
        server.process.send_signal(signal.SIGTERM)
        for port in (server.port, grpc):
            for _ in range(400):
                try:
                    socket.create_connection(("127.0.0.1", port), 20).close()
                except ConnectionRefusedError:
                    break
                threading.Event().wait(0.02)
            else:
                raise Failed("a front takes connections while the server drains")
        check(server.process.poll() is None, "the server did not wait for the body")
        busy.sendall(BLOB[1000:])
        check(statuses(busy.recv(65536)) == [201], "the request under way was cut")
        equal(server.process.wait(30), 0, "exit code")


def drain_has_an_end(binary):
    with Cached(binary, timeouts_drain="300ms") as server:
        s = server.connect()
        s.sendall(PUT + b"b")
        equal(server.get(BLOB).status, 404, "not yet there")
        server.process.send_signal(signal.SIGTERM)
        equal(server.process.wait(30), 0, "exit code though a client never ended")


if __name__ == "__main__":
    main([deadlines, caps, announced_memory, unwanted_bodies, unread_records, in_flight, goes_away, drains, trickles, drains_both, drain_has_an_end])
