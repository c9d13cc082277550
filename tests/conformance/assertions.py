"""Assertions about a running server, each under the name or number that the OGC's test suite gives it."""

import io
import os
import re
import sys
import urllib.error
import urllib.parse
import urllib.request
import xml.etree.ElementTree as ElementTree

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "clients"))
from served_map import SKIPPED, skip  # noqa: E402

try:
    from lxml import etree
    from PIL import Image
except ImportError as error:
    skip(f"python3-lxml and python3-pil are not installed ({error})")

# Debian's MapProxy package contains the OGC schemas.
SCHEMAS = "/usr/share/python3-mapproxy/test/schemas"


class Answer:
    """A response, whatever its status."""

    def __init__(self, status, headers, body):
        self.status = status
        self.type = headers.get("Content-Type", "").split(";")[0].strip()
        self.body = body

    def xml(self):
        return ElementTree.fromstring(self.body)

    def picture(self):
        return Image.open(io.BytesIO(self.body)).convert("RGBA")


def ask(url):
    try:
        with urllib.request.urlopen(url, timeout=60) as response:
            return Answer(response.status, response.headers, response.read())
    except urllib.error.HTTPError as refused:
        return Answer(refused.code, refused.headers, refused.read())


def in_odd_case(key):
    """"REQUEST" as "ReQuEsT": parameter names are case-insensitive."""
    return "".join(c.upper() if i % 2 == 0 else c.lower() for i, c in enumerate(key))


def with_query(prefix, **pairs):
    query = "&".join(f"{in_odd_case(key) if key.isupper() or '_' in key else key}={urllib.parse.quote(str(value), safe=',:/')}"
                     for key, value in pairs.items() if value is not None)
    return prefix + query


def expect_picture(answer, kind, size=None):
    assert answer.status == 200, (answer.status, answer.body[:400])
    assert answer.type == kind, answer.type
    if size:
        assert answer.picture().size == size, answer.picture().size


class NearbySchemas(etree.Resolver):
    """Resolves the schemas of the OGC and the W3C to local files, and loads nothing from the network."""

    def resolve(self, url, public_id, context):
        for prefix in ("http://schemas.opengis.net", "https://schemas.opengis.net"):
            if url.startswith(prefix):
                return self.resolve_filename(SCHEMAS + url[len(prefix):], context)
        if url.startswith("http"):
            return self.resolve_filename(os.path.join(SCHEMAS, os.path.basename(url)), context)
        return None


def has_schemas():
    return os.path.isdir(SCHEMAS)


# As first published, the schema counted tiles from 1, unlike the standard; the OGC has corrected it.
ROW_ZERO = re.compile(r"(Min|Max)Tile(Row|Col)': '0' is not a valid value of the atomic type 'xs:positiveInteger'")

_schemas = {}


def expect_valid(document, schema):
    """Validates against an XML Schema or a DTD of the OGC, where Debian's are installed."""
    if not has_schemas():
        return
    path = os.path.join(SCHEMAS, schema)
    if schema not in _schemas:
        if schema.endswith(".dtd"):
            _schemas[schema] = etree.DTD(path)
        else:
            parser = etree.XMLParser(no_network=True)
            parser.resolvers.add(NearbySchemas())
            _schemas[schema] = etree.XMLSchema(etree.parse(path, parser))
    parser = etree.XMLParser(no_network=True, load_dtd=False, resolve_entities=False)
    tree = etree.fromstring(document, parser)
    if not _schemas[schema].validate(tree):
        errors = [error.message for error in _schemas[schema].error_log if not ROW_ZERO.search(error.message)]
        assert not errors, errors[:3]


class Suite:
    """Assertions in the order in which they are written; a failure does not hide those that follow."""

    def __init__(self, title):
        self.title = title
        self.assertions = []

    def __call__(self, *names):
        def remember(function):
            self.assertions.append((names, function))
            return function
        return remember

    def run(self, *arguments):
        failed = 0
        count = 0
        for names, function in self.assertions:
            count += len(names)
            try:
                function(*arguments)
            except Exception as error:  # any error counts against that assertion
                failed += 1
                print(f"FAILED {', '.join(names)}\n  {function.__doc__}\n  "
                      f"{type(error).__name__}: {error}")
        schemas = "" if has_schemas() else "; without schemas, which Debian's MapProxy brings along"
        print(f"{self.title}: {count} assertions, {failed} failures{schemas}")
        return 1 if failed else 0 if has_schemas() else SKIPPED
