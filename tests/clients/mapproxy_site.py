"""MapProxy as an application inside the test, without a socket."""

import io
import os
import sys

from served_map import skip

try:
    from mapproxy.wsgiapp import make_wsgi_app
except ImportError as error:
    skip(f"MapProxy is not installed ({error})")


# The last part of a configuration; {folder} is not filled in yet.
GLOBALS = """
globals:
  cache:
    base_dir: {folder}/cache
    lock_dir: {folder}/locks
  image:
    paletted: false
"""


class MapProxySite:
    """A site with this configuration, which is written into a folder."""

    def __init__(self, config, folder):
        file_name = os.path.join(folder, "mapproxy.yaml")
        with open(file_name, "w", encoding="utf-8") as file:
            file.write(config)
        self.app = make_wsgi_app(file_name)

    def ask(self, path, query=""):
        """Sends a GET request; returns status and body."""
        seen = []
        environ = {
            "REQUEST_METHOD": "GET", "PATH_INFO": path, "QUERY_STRING": query, "SCRIPT_NAME": "",
            "SERVER_NAME": "localhost", "SERVER_PORT": "80", "SERVER_PROTOCOL": "HTTP/1.1",
            "HTTP_HOST": "localhost", "wsgi.url_scheme": "http", "wsgi.input": io.BytesIO(),
            "wsgi.errors": sys.stderr, "wsgi.version": (1, 0), "wsgi.multithread": False,
            "wsgi.multiprocess": False, "wsgi.run_once": False,
        }
        body = b"".join(self.app(environ, lambda status, headers, exc=None: seen.append(status)))
        return seen[0], body
