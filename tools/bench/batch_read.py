#!/usr/bin/env python3
"""BatchReadBlobs of kiln-cached beside buildbox-casd (tools/peers.sh) on loopback in one run: blobs a second and their ratio.

usage: batch_read.py KILN_CACHED BATCH_READ_BENCH [--seconds S] [--rounds N]. Both hold the same thousand blobs in files; kiln-cached
hashes what it reads, once in verify_again seconds. Rounds alternate between the servers; a ratio is the median of the rounds',
over 1 where kiln-cached is faster. "cpu" is the server's processor time a blob, which a busy machine disturbs less.
"""
import argparse
import os
import pathlib
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent / "tests" / "server"))
from cached import Cached  # noqa: E402
from peers import Daemon, Home, Peers, free_port  # noqa: E402

ROWS = [(2048, 1, 1), (2048, 100, 1), (20_480, 1, 1), (20_480, 10, 1), (20_480, 100, 1), (20_480, 100, 4), (51_200, 50, 1)]


def processor_time(pid):
    """Seconds of a process and all that it started."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cached")
    parser.add_argument("bench")
    parser.add_argument("--seconds", type=float, default=1)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    peers, port = Peers(), free_port()
    with Home() as home, Cached(os.path.abspath(options.cached), grpc="127.0.0.1:0", log="off") as ours:
        address = ours.process.stdout.readline().decode().split()[1]
        with Daemon(peers.tool("buildbox-casd", f"--bind=127.0.0.1:{port}", "--quota-high=1G", "--reserved=1M", "--log-level=error", home / "casd"),
                    home, port) as casd:
            servers = {"kiln-cached": (address, ours.process.pid), "casd": (f"127.0.0.1:{port}", casd.process.pid)}

            def bench(verb, name, size, batch, callers):
                return subprocess.run([options.bench, verb, servers[name][0], *map(str, (size, batch, callers, options.seconds))], check=True,
                                      capture_output=True, text=True).stdout

            print(f"{'size':>7} {'batch':>6} {'callers':>8} {'kiln-cached/s':>14} {'casd/s':>10} {'ratio':>7} {'cpu us':>8} {'casd':>7} {'ratio':>7}")
            for size, batch, callers in ROWS:
                for name in servers:
                    bench("fill", name, size, batch, callers)
                rates, cpus = {name: [] for name in servers}, {name: [] for name in servers}
                for _ in range(options.rounds):
                    for name in servers:
                        before = processor_time(servers[name][1])
                        rate = float(bench("read", name, size, batch, callers))
                        rates[name].append(rate)
                        cpus[name].append((processor_time(servers[name][1]) - before) / (rate * options.seconds) * 1e6)
                ratio = statistics.median(a / b for a, b in zip(rates["kiln-cached"], rates["casd"]))
                cpu = statistics.median(b / max(a, 1e-9) for a, b in zip(cpus["kiln-cached"], cpus["casd"]))
                a, b = (statistics.median(rates[name]) for name in servers)
                c, d = (statistics.median(cpus[name]) for name in servers)
                print(f"{size:>7} {batch:>6} {callers:>8} {a:>14.0f} {b:>10.0f} {ratio:>7.2f} {c:>8.1f} {d:>7.1f} {cpu:>7.2f}", flush=True)


if __name__ == "__main__":
    main()
