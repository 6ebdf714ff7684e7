"""Systems as SSP 1.0 files.

Reading: `document` parses and validates, `tree` follows the files, `network` and `bindings` find what feeds and sets
what, `carrying` what becomes of values, `flattening` makes the system. Writing: `export`.
"""
