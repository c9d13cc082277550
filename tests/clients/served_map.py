"""A running `trapeze serve` with the two small layers of tests/browser."""

import os
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from contextlib import contextmanager

SKIPPED = 77
START_SECONDS = 60  # enough for sanitizers on a busy machine
FIXTURES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "browser")

CONFIG = """
[server]
address = "127.0.0.1"

[styles.night.land]
fill = "#405060"

[[layer]]
name = "land"
file = "{fixtures}/land.geojson"
style = {{ fill = "#d8c99b" }}

[[layer]]
name = "lake"
file = "{fixtures}/lake.geojson"
style = {{ fill = "#4f8fba" }}
"""


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(SKIPPED)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def get(url):
    with urllib.request.urlopen(url, timeout=30) as answer:
        return answer.read()


def wait_until_ready(base, server):
    end = time.monotonic() + START_SECONDS
    while time.monotonic() < end and server.poll() is None:
        try:
            get(base + "ready")
            return
        except OSError:
            time.sleep(0.1)
    raise RuntimeError("trapeze serve did not get ready")


@contextmanager
def served_map(config_text=CONFIG, write_data=lambda folder: None):
    """The address of the server, and a folder that is removed with it, whose name is {folder} in the text of the
    configuration, and into which the data is written."""
    with tempfile.TemporaryDirectory(prefix="trapeze-clients-") as folder:
        write_data(folder)
        config = os.path.join(folder, "trapeze.toml")
        with open(config, "w", encoding="utf-8") as file:
            file.write(config_text.format(fixtures=FIXTURES, folder=folder))
        port = free_port()
        with open(os.path.join(folder, "log"), "wb") as log:
            server = subprocess.Popen(
                [sys.argv[1], "serve", "--config", config, "--port", str(port)],
                stdout=log, stderr=subprocess.STDOUT)
        try:
            base = f"http://127.0.0.1:{port}/"
            wait_until_ready(base, server)
            yield base, folder
        except BaseException:
            server.kill()
            raise
        server.terminate()
        status = server.wait(30)
        if status != 0:
            with open(os.path.join(folder, "log"), encoding="utf-8", errors="replace") as log:
                raise RuntimeError(f"trapeze serve ended with {status}:\n{log.read()[-4000:]}")
