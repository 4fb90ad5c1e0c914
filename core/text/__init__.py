"""Text that others wrote, read and written within limits.

- `plain`: one printable line of any text, without markup
- `secrets`: masked keys
- `safe_json`, `safe_xml`: JSON and XML from outside
- `markup`: HTML pages that need nothing from elsewhere
"""
