"""Foreign text, read and written within limits.

- `plain`: numbers, times and one printable line of any text
- `secrets`: masking of keys
- `safe_json`, `safe_xml`: JSON and XML from outside
- `markup`: self-contained HTML pages
"""
