#!/usr/bin/env python3
"""Checks configurations (TOML) against a schema (JSON Schema, draft 2020-12).

    validate_config.py SCHEMA [--refuse] CONFIG ...

With --refuse, every configuration must violate the schema instead. Exits with status 1 if a configuration is
not as expected, and with 77 (skipped, for CTest) if Debian's python3-jsonschema is not installed.
"""
import json
import sys
import tomllib

try:
    import jsonschema
except ImportError:
    print("python3-jsonschema is not installed")
    sys.exit(77)


def main():
    arguments = sys.argv[1:]
    must_break = "--refuse" in arguments
    schema_path, *configs = [a for a in arguments if a != "--refuse"]
    with open(schema_path, encoding="utf-8") as file:
        schema = json.load(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    failures = 0
    for path in configs:
        with open(path, "rb") as file:
            config = tomllib.load(file)
        errors = [f"{'.'.join(map(str, e.absolute_path))}: {e.message}"
                  for e in validator.iter_errors(config)]
        if bool(errors) != must_break:
            failures += 1
            print(f"{path}: {'; '.join(errors) or 'should break the schema, but does not'}")
    sys.exit(1 if failures else 0)


main()
