#!/usr/bin/env python3
"""BatchReadBlobs of kiln-cached beside buildbox-casd (tools/peers.sh) on loopback in one run: blobs a second and their ratio.

usage: batch_read.py KILN_CACHED BATCH_READ_BENCH [--seconds S] [--rounds N] [--before KILN_CACHED]. Both hold the same thousand blobs in files; kiln-cached
hashes what it reads, once in verify_again seconds. Rounds alternate between the servers; a ratio is the median of the rounds',
over 1 where kiln-cached is faster. "cpu" is the server's processor time a blob, which a busy machine disturbs less. With --before, the same of another kiln-cached in the same run.
"""
import argparse
import contextlib
import os
import pathlib
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent / "tests" / "server"))
from cached import Cached  # noqa: E402
from peers import Daemon, Home, Peers, free_port  # noqa: E402

ROWS = [(size, batch, connections) for size in (2048, 20_480, 51_200) for batch in (1, 10, min(100, 2_500_000 // size)) for connections in (1, 8)]


def processor_time(pid):
    """Seconds of a process and all that it started."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cached")
    parser.add_argument("bench")
    parser.add_argument("--before")
    parser.add_argument("--seconds", type=float, default=1)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    peers, port = Peers(), free_port()
    with contextlib.ExitStack() as stack:
        home = stack.enter_context(Home())
        servers = {}
        for name, binary in [("kiln-cached", options.cached)] + ([("before", options.before)] if options.before else []):
            server = stack.enter_context(Cached(os.path.abspath(binary), grpc="127.0.0.1:0", log="off"))
            servers[name] = (server.process.stdout.readline().decode().split()[1], server.process.pid)
        casd = stack.enter_context(Daemon(peers.tool("buildbox-casd", f"--bind=127.0.0.1:{port}", "--quota-high=1G", "--reserved=1M", "--log-level=error", home / "casd"),
                                          home, port))
        servers["casd"] = (f"127.0.0.1:{port}", casd.process.pid)

        def bench(verb, name, size, batch, connections):
            return subprocess.run([options.bench, verb, servers[name][0], *map(str, (size, batch, connections, options.seconds))], check=True,
                                  capture_output=True, text=True).stdout

        print(f"{'size':>7} {'batch':>6} {'connections':>12}" + "".join(f" {name + '/s':>14} {'cpu us':>7}" for name in servers)
              + "".join(f" {'/ ' + name:>9} {'cpu':>5}" for name in list(servers)[1:]))
        for size, batch, connections in ROWS:
            rates, cpus = {name: [] for name in servers}, {name: [] for name in servers}
            for name in servers:
                bench("fill", name, size, batch, 1)
            for _ in range(options.rounds):
                for name, (_, pid) in servers.items():
                    before = processor_time(pid)
                    rates[name].append(float(bench("read", name, size, batch, connections)))
                    cpus[name].append((processor_time(pid) - before) / (rates[name][-1] * options.seconds) * 1e6)
            line = f"{size:>7} {batch:>6} {connections:>12}"
            for name in servers:
                line += f" {statistics.median(rates[name]):>14.0f} {statistics.median(cpus[name]):>7.1f}"
            for name in list(servers)[1:]:
                line += f" {statistics.median(a / b for a, b in zip(rates['kiln-cached'], rates[name])):>9.2f}"
                line += f" {statistics.median(b / max(a, 1e-9) for a, b in zip(cpus['kiln-cached'], cpus[name])):>5.2f}"
            print(line, flush=True)


if __name__ == "__main__":
    main()
