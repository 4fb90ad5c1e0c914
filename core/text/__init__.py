"""Foreign text, read and written within limits.

- `plain`: parsing of numbers and times, and reduction of any text to one printable line
- `ranges`: numbers and ranges such as 3,7-9
- `secrets`: masking of keys
- `safe_json`, `safe_xml`: parsing of foreign JSON and XML
- `markup`: self-contained HTML pages
"""
