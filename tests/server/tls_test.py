#!/usr/bin/env python3
"""TLS: which versions, which certificates, slow and broken handshakes, certificates changed under way.

usage: tls_test.py KILN_CACHED [TEST...]. openssl(1) makes the certificates and is the peer that speaks old versions.
"""
import http.client
import pathlib
import shutil
import signal
import socket
import ssl
import subprocess
import tempfile

from cached import Cached, Failed, check, equal, key, main, skip, statuses

SECRET = "a-token-that-goes-over-tls"
BLOB = b"t" * 200_000


class Certificates:
    def __enter__(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        return self

    def __exit__(self, *_):
        self.folder.cleanup()

    def make(self, name):
        cert, private = self.path / (name + ".pem"), self.path / (name + ".key")
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2",
                        "-subj", "/CN=" + name, "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", private, "-out", cert], check=True, stderr=subprocess.DEVNULL)
        return cert, private


def served(binary, pair, **more):
    return Cached(binary, instances=["name: main"], tokens=[f"ci {SECRET} main:read,cas-write,ac-write"], tls_certificate=pair[0], tls_key=pair[1], **more)


def versions(binary):
    with Certificates() as made, served(binary, made.make("a")) as server:
        equal(server.put(BLOB, "/main", token=SECRET), 201, "PUT over TLS")
        equal(server.get(BLOB, "/main", token=SECRET).body, BLOB, "GET over TLS")
        equal(server.get(BLOB, "/main").status, 401, "GET without a token")
        for flag, works in (("-tls1_2", True), ("-tls1_3", True), ("-tls1_1", False), ("-tls1", False)):
            done = subprocess.run(["openssl", "s_client", "-connect", f"127.0.0.1:{server.port}", flag, "-cipher", "DEFAULT:@SECLEVEL=0", "-quiet", "-no_ign_eof"],
                                  input=b"", stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=30)
            equal(done.returncode == 0, works, "openssl s_client " + flag + done.stderr.decode()[-200:])
        got = server.raw(b"GET /healthz HTTP/1.1\r\nHost: h\r\n\r\n")
        check(b"200 OK" not in got, "plain HTTP is answered on a TLS port")
        context = ssl.create_default_context()
        c = http.client.HTTPSConnection("127.0.0.1", server.port, context=context, timeout=20)
        try:
            c.request("GET", "/healthz")
            raise Failed("a certificate that nobody has signed was taken: the test's client checks nothing")
        except ssl.SSLCertVerificationError:
            pass


def handshakes(binary):
    """Connections that never shake hands, or badly, end; others are served meanwhile."""
    with Certificates() as made, served(binary, made.make("a"), timeouts_head="500ms") as server:
        equal(server.put(BLOB, "/main", token=SECRET), 201, "positive control")
        held = [server.connect() for _ in range(50)]
        for i, s in enumerate(held):
            s.sendall(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"[:i % 12] + (b"rubbish" * 100 if i % 3 == 0 else b""))
        equal(server.get(BLOB, "/main", token=SECRET).body, BLOB, "another client meanwhile")
        for s in held:
            try:
                while s.recv(65536):
                    pass
            except ConnectionResetError:
                pass
            s.close()
        equal(server.get(BLOB, "/main", token=SECRET).body, BLOB, "another client afterwards")


def slow(binary):
    """Slow at the head, the body, reading, or doing nothing, and gone without a word: all over TLS; others are served."""
    short = {f"timeouts_{what}": "500ms" for what in ("head", "body", "write", "idle")}
    large = b"L" * (32 << 20)
    auth = f"Host: h\r\nAuthorization: Bearer {SECRET}\r\n"
    with Certificates() as made, served(binary, made.make("a"), **short) as server:
        equal(server.put(BLOB, "/main", token=SECRET), 201, "positive control")
        equal(server.put(large, "/main", token=SECRET), 201, "positive control: 32 MiB")
        context = ssl.create_default_context(cafile=made.path / "a.pem")

        def connect(say=b"", buffer=None):
            s = socket.socket()
            s.settimeout(20)
            if buffer:
                s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
            s.connect(("127.0.0.1", server.port))
            s = context.wrap_socket(s, server_hostname="127.0.0.1")
            s.sendall(say)
            return s

        def rest(s):
            """What still comes until the server ends the connection."""
            got = 0
            try:
                while part := s.recv(1 << 20):
                    got += len(part)
            except (ssl.SSLError, ConnectionError):  # closed without TLS's farewell
                pass
            s.close()
            return got

        ask = f"GET /main/cas/{key(large)} HTTP/1.1\r\n{auth}\r\n".encode()
        held = {"head": connect(b"GET /main/cas/"), "idle": connect(),
                "body": connect(f"PUT /main/cas/{key(b'x' * 9)} HTTP/1.1\r\n{auth}Content-Length: 9\r\n\r\nxxx".encode()),
                "reader": connect(ask, 4096)}
        for _ in range(20):  # gone in the middle of a response
            connect(ask).close()
        equal(server.get(BLOB, "/main", token=SECRET).body, BLOB, "another client meanwhile")
        for what in ("head", "idle", "body"):
            equal(rest(held[what]), 0, what)
        timeouts = lambda: [float(line.split()[-1]) for line in server.call("GET", "/metrics", token=SECRET).body.decode().splitlines()
                            if "timeout" in line and line[0] != "#"][0]
        for _ in range(200):  # the reader reads nothing until the server has given up
            if timeouts() >= 3:
                break
            signal.sigtimedwait([], 0.05)
        got = rest(held["reader"])
        check(got < len(large), f"a client that did not read got all {got} bytes")
        equal(server.get(large, "/main", token=SECRET).body, large, "a client that does read")
        # Requests in a row, and a body of many records.
        s = connect(2 * f"GET /main/cas/{key(BLOB)} HTTP/1.1\r\n{auth}\r\n".encode())
        got = b""
        while got.count(b"HTTP/1.1 200") < 2 or len(got) < 2 * len(BLOB):
            got += s.recv(1 << 20)
        check(got.count(BLOB) == 2, "two requests in a row")
        body = bytes(range(256)) * 8
        s.sendall(f"PUT /main/cas/{key(body)} HTTP/1.1\r\n{auth}Content-Length: {len(body)}\r\n\r\n".encode())
        for at in range(0, len(body), 16):
            s.sendall(body[at:at + 16])
        check(b" 201 " in s.recv(65536), "a body in small records")
        s.close()
        equal(server.get(body, "/main", token=SECRET).body, body, "a body in small records")


def changed(binary):
    """SIGHUP takes a new certificate; one that is broken keeps the old; a key that is not the certificate's starts no server."""
    with Certificates() as made:
        a, b = made.make("a"), made.make("b")
        used = made.path / "used.pem", made.path / "used.key"
        copy = lambda pair: [shutil.copy(x, y) for x, y in zip(pair, used)]
        copy(a)
        with served(binary, used) as server:
            def name():
                done = subprocess.run(["openssl", "s_client", "-connect", f"127.0.0.1:{server.port}"], input=b"", stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                return done.stdout.decode().partition("subject=")[2].splitlines()[0].replace(" ", "")

            def hang_up():
                lines = server.log().count('"reloaded"')
                server.process.send_signal(signal.SIGHUP)
                for _ in range(2000):
                    if server.log().count('"reloaded"') > lines:
                        return
                    signal.sigtimedwait([], 0.005)
                raise Failed("SIGHUP did nothing")

            equal(name(), "CN=a", "before")
            copy(b)
            equal(name(), "CN=a", "before SIGHUP")
            hang_up()
            equal(name(), "CN=b", "after")
            used[0].write_text("nonsense")
            hang_up()
            equal(name(), "CN=b", "after a broken certificate")
        words = lambda cert, private: [binary, f"--folder={made.path}/s", "--listen=127.0.0.1:0", f"--tls.certificate={cert}", f"--tls.key={private}"]
        for cert, private, what in ((a[0], b[1], "another's key"), (a[0], made.path / "none", "no key"), (a[1], a[1], "a key as certificate")):
            done = subprocess.run(words(cert, private), stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=30)
            check(done.returncode not in (0, None) and b"http 127" not in done.stdout, f"a server starts with {what}")


if __name__ == "__main__":
    if shutil.which("openssl") is None:
        skip("openssl is not installed")
    main([versions, handshakes, slow, changed])
