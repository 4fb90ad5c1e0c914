"""Files, on this machine and in object stores.

- `redirects`, `store_requests`, `stores`: object stores by the addresses of fsspec
- `files`: files written whole or not at all, and locked by one run at a time
- `config`: named things in the user's configuration folder
"""
