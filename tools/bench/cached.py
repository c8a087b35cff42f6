#!/usr/bin/env python3
"""kiln-cached beside nginx on loopback in one run, with wrk: rates, their ratios, memory with 1,000 connections.

usage: cached.py KILN_CACHED [--seconds S] [--rounds N] [--where DIR]. Both keep their files below DIR, by default in memory: a
disk's own noise (ext4 looks for an inode for half a millisecond where many were deleted lately) is in both and tells nothing. nginx serves the same bytes as static files and takes PUTs by its DAV
module, neither verified nor flushed; kiln-cached verifies both and here flushes nothing either (`file` is the row with its
default, which does; "no pool" is --threads.work 0: like nginx's worker, it writes files on the thread that serves sockets). Neither writes a request log. Rounds alternate between the servers; a ratio is the median of the rounds',
over 1 where kiln-cached is faster. "cpu" is the server's processor time a request, which a busy machine disturbs less.
"""
import argparse
import hashlib
import os
import pathlib
import re
import shutil
import socket
import ssl
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent / "tests" / "server"))
from cached import Cached, key  # noqa: E402

SIZES, CONNECTIONS = (2048, 20_480, 51_200), (1, 8)

NGINX = """
daemon off; master_process off; pid {home}/pid; error_log {home}/error.log; worker_rlimit_nofile 8192;
events {{ worker_connections 4096; }}
http {{
  access_log off; sendfile on; tcp_nopush on; keepalive_requests 100000000; client_max_body_size 64m;
  client_body_temp_path {home}/body; proxy_temp_path {home}/t1; fastcgi_temp_path {home}/t2; uwsgi_temp_path {home}/t3; scgi_temp_path {home}/t4;
  server {{ listen 127.0.0.1:{port}; root {home}/www; location / {{ dav_methods PUT; create_full_put_path on; }} }}
}}
"""

# Bodies that differ in their first bytes, under names worked out beforehand; past the last name the run is no measurement.
PUT = """
local names, at, padding = {{}}, 0, string.rep("p", {size} - 16)
for line in io.lines("{names}") do names[#names + 1] = line end
function request()
  at = at + 1
  if at > #names then wrk.thread:stop() return wrk.format("GET", "/healthz") end
  return wrk.format("PUT", "/cas/" .. names[at], nil, string.format("{run:06d}%010d", at) .. padding)
end
function done(summary, latency, requests)
  io.write(string.format("errors %d\\n", summary.errors.status + summary.errors.connect + summary.errors.read + summary.errors.write + summary.errors.timeout))
end
"""


class Nginx:
    def __enter__(self):
        self.home = pathlib.Path(tempfile.mkdtemp(prefix="kiln-nginx-"))
        (self.home / "www" / "cas").mkdir(parents=True)
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))
            self.port = s.getsockname()[1]
        (self.home / "nginx.conf").write_text("user root;" * (os.geteuid() == 0) + NGINX.format(home=self.home, port=self.port))
        self.process = subprocess.Popen(["nginx", "-p", str(self.home), "-c", str(self.home / "nginx.conf"), "-e", str(self.home / "error.log")])
        for _ in range(100):
            try:
                socket.create_connection(("127.0.0.1", self.port), 1).close()
                break
            except OSError:
                time.sleep(0.05)
        self.url = f"http://127.0.0.1:{self.port}"
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        shutil.rmtree(self.home, ignore_errors=True)


def processor_time(server):
    """Seconds of all threads; they live as long as the server."""
    tasks = pathlib.Path(f"/proc/{server.process.pid}/task")
    return sum(int((task / "schedstat").read_text().split()[0]) for task in tasks.iterdir()) / 1e9


def wrk(server, path, connections, seconds, script=None):
    """Requests a second, and the server's processor time a request in microseconds."""
    words = ["wrk", "-t1", f"-c{connections}", f"-d{seconds}s"] + (["-s", str(script)] if script else []) + [server.url + path]
    before = processor_time(server)
    out = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=True).stdout.decode()
    if "Non-2xx" in out or not re.search(r"errors 0$|^(?!.*errors)", out, re.M):
        sys.exit("wrk saw errors:\n" + out)
    used = processor_time(server) - before
    return float(re.search(r"Requests/sec:\s+([0-9.]+)", out).group(1)), used * 1e6 / int(re.search(r"(\d+) requests in", out).group(1))


class Puts:
    """A wrk script of fresh bodies for one run."""
    run = 0

    def __init__(self, home, size, seconds, rate):
        Puts.run += 1
        names = home / f"names{Puts.run}"
        padding = b"p" * (size - 16)
        with open(names, "w") as out:
            for i in range(1, int(rate * seconds) + 1):
                out.write(hashlib.sha256(b"%06d%010d" % (Puts.run, i) + padding).hexdigest() + "\n")
        self.path = home / f"put{Puts.run}.lua"
        self.path.write_text(PUT.format(size=size, names=names, run=Puts.run))


def ratios(what, one, two, rounds):
    ours, theirs = [], []
    for _ in range(rounds):
        ours.append(one())
        theirs.append(two())
    middle = lambda runs, which: statistics.median(run[which] for run in runs)
    faster = statistics.median(a[0] / b[0] for a, b in zip(ours, theirs))
    cheaper = statistics.median(b[1] / a[1] for a, b in zip(ours, theirs))
    print(f"{what:<26} {middle(ours, 0):>8.0f}/s {middle(theirs, 0):>8.0f}/s {faster:>7.2f}   {middle(ours, 1):>6.1f} us {middle(theirs, 1):>6.1f} us {cheaper:>7.2f}",
          flush=True)


def memory(binary, tls):
    """Resident bytes with 1,000 connections that have each read a blob and stay."""
    with tempfile.TemporaryDirectory() as folder:
        pair = [os.path.join(folder, name) for name in ("cert.pem", "key.pem")]
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj", "/CN=localhost",
                        "-addext", "subjectAltName=IP:127.0.0.1", "-out", pair[0], "-keyout", pair[1]], check=True, stderr=subprocess.DEVNULL)
        with Cached(binary, log="off", limits_connections=2000, **(dict(zip(("tls_certificate", "tls_key"), pair)) if tls else {})) as server:
            context = ssl.create_default_context(cafile=pair[0])
            blob = b"m" * 20_480
            server.put(blob)
            before = server.memory()
            held = []
            for _ in range(1000):
                s = server.connect()
                if tls:
                    s = context.wrap_socket(s, server_hostname="127.0.0.1")
                s.sendall(f"GET /cas/{key(blob)} HTTP/1.1\r\nHost: h\r\n\r\n".encode())
                held.append(s)
            for s in held:
                got = 0
                while got < len(blob):
                    got += len(s.recv(65536))
            now = server.memory()
            for s in held:
                s.close()
    print(f"memory: {before / 2**20:.1f} MiB idle, {now / 2**20:.1f} MiB with 1,000 {'TLS ' * tls}connections (asked: at most 64)", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("binary")
    parser.add_argument("--seconds", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--where", default="/dev/shm")
    options = parser.parse_args()
    for program in ("wrk", "nginx"):
        if shutil.which(program) is None:
            sys.exit(f"{program} is not installed (tools/setup.sh)")
    import resource
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(8192, resource.getrlimit(resource.RLIMIT_NOFILE)[1]),) * 2)
    binary = os.path.abspath(options.binary)
    tempfile.tempdir = options.where
    print(f"{'':<26} {'kiln-cached':>10} {'nginx':>10} {'ratio':>7} {'cpu':>11} {'nginx':>9} {'ratio':>7}")
    with Nginx() as nginx, Cached(binary, log="off", limit="60GiB") as ours, Cached(binary, log="off", limit="60GiB", sync="file") as flushed, \
            Cached(binary, log="off", limit="60GiB", threads_work=0) as alone:
        home = nginx.home
        for size in SIZES:
            blob = os.urandom(size)
            ours.put(blob)
            (home / "www" / "cas" / key(blob)).write_bytes(blob)
            for c in CONNECTIONS:
                get = lambda server: wrk(server, f"/cas/{key(blob)}", c, options.seconds)
                ratios(f"GET {size // 1024:>2} KiB, {c} connections", lambda: get(ours), lambda: get(nginx), options.rounds)
        rate = 16_000
        for size in SIZES:
            for c in CONNECTIONS:
                put = lambda server: wrk(server, "", c, options.seconds, Puts(home, size, options.seconds, rate).path)
                ratios(f"PUT {size // 1024:>2} KiB, {c} connections", lambda: put(ours), lambda: put(nginx), options.rounds)
                ratios("  the same, no pool", lambda: put(alone), lambda: put(nginx), options.rounds)
                if size == SIZES[1]:
                    ratios("  the same, --sync file", lambda: put(flushed), lambda: put(nginx), 1)
    memory(binary, False)
    memory(binary, True)


if __name__ == "__main__":
    main()
