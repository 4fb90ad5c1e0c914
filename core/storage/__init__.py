"""Files on this machine and in object stores.

- `redirects`, `store_requests`, `stores`: object stores, by fsspec addresses
- `files`: files written atomically, and locked by one run at a time
- `config`: named entries in the user's configuration folder
"""
