"""List prices of two clouds, and what img2dataset says of itself: plain values, each with its source and its date.

They were looked up in stored copies of public pages on 2026-11-24; neither cloud was asked. ``stated`` is the date that
the source gives itself; where it gives none, the figure may be older than the copy. Prices are in US dollars, on demand
and without taxes, free allowances or discounts for long use. A figure that no source has is left out.
"""

from __future__ import annotations

from typing import NamedTuple

LOOKED_UP = "2026-11-24"


class Price(NamedTuple):
    """A list price.

    Attributes
    ----------
    usd : float
        Of one ``unit``.
    unit, what : str
    stated : str
        Date that the source gives; empty where it gives none.
    source : str
    """

    usd: float
    unit: str
    what: str
    stated: str
    source: str


class Rate(NamedTuple):
    """What a program's own documents say of its speed.

    Attributes
    ----------
    images_per_s : float
        Of all machines together.
    machines, cores : int or None
        Cores of each machine; None where they are not said.
    what, source : str
    """

    images_per_s: float
    machines: int
    cores: int | None
    what: str
    source: str


#: Found by its text in a public source file whose repository is unknown.
_RATE_TABLE = "a table of rates in a public source file"

#: By cloud: what an hour of a vCPU, a GB stored for a month, a thousand requests and a GB sent to the Internet cost.
PRICES: dict[str, dict[str, Price]] = {
    "aws": {
        "vcpu_hour": Price(
            0.1008 / 2,
            "vCPU hour",
            "EC2 m7i.large (2 vCPU, $0.1008 an hour), Linux, us-east-1",
            "2026-09",
            f"{_RATE_TABLE}: 'On-demand Linux rates, us-east-1, as published 2026-09'",
        ),
        "arm_vcpu_hour": Price(
            0.0816 / 2,
            "vCPU hour",
            "EC2 m7g.large (2 vCPU of Graviton, $0.0816 an hour), Linux, us-east-1",
            "2026-06-17",
            "https://www.factualminds.com/blog/amazon-ec2-on-demand-pricing-instance-families-2026/",
        ),
        "storage_gb_month": Price(
            0.023,
            "GB month",
            "S3 Standard, us-east-1",
            "2026-03-13",
            "https://cloudburn.io/blog/amazon-s3-pricing",
        ),
        "put_1000": Price(
            0.005,
            "1,000 requests",
            "S3 Standard: PUT, COPY, POST, LIST",
            "",
            "https://c3x.dev/blog/s3-request-fees-explained",
        ),
        "get_1000": Price(
            0.0004,
            "1,000 requests",
            "S3 Standard: GET, HEAD, SELECT",
            "",
            "https://c3x.dev/blog/s3-request-fees-explained",
        ),
        "egress_gb": Price(
            0.09,
            "GB",
            "to the Internet, of the first 10 TB a month; beyond see AWS_EGRESS",
            "2026-03-08",
            "https://wring.co/blog/aws-data-transfer-pricing-guide",
        ),
    },
    "google": {
        "vcpu_hour": Price(
            0.1942 / 4,
            "vCPU hour",
            "Compute Engine n2-standard-4 (4 vCPU, $0.1942 an hour), regions of the USA at the base price",
            "2026-09-06",
            f"{_RATE_TABLE}: Google's published reference price, 'consultado em 2026-09-06'",
        ),
        "storage_gb_month": Price(
            0.020,
            "GB month",
            "Cloud Storage Standard, us-central1",
            "2026-04-09",
            "https://leanopstech-web.pages.dev/blog/google-cloud-storage-pricing-2026/; "
            "the same in https://cloud.google.com/storage/pricing-examples for us-east1, without a date",
        ),
        "put_1000": Price(
            0.005,
            "1,000 requests",
            "Cloud Storage Standard: class A (adds and listings)",
            "",
            "https://cloud.google.com/storage/pricing-examples",
        ),
        "get_1000": Price(
            0.0004,
            "1,000 requests",
            "Cloud Storage Standard: class B (gets)",
            "",
            "https://cloud.google.com/storage/pricing-examples",
        ),
        "egress_gb": Price(
            0.12,
            "GB",
            "to the Internet, of the first TB a month",
            "2026-04-09",
            "https://leanopstech-web.pages.dev/blog/google-cloud-storage-pricing-2026/; "
            "the same in https://cloud.google.com/storage/pricing-examples, without a date",
        ),
    },
}

#: Of AWS, US dollars for a GB to the Internet up to so many TB a month; source and date are those of ``egress_gb``.
AWS_EGRESS = ((10.0, 0.09), (50.0, 0.085), (150.0, 0.07), (float("inf"), 0.05))

_IMG2DATASET = "https://github.com/rom1504/img2dataset"
_README = f"{_IMG2DATASET}/blob/003aaab627cdcd0448a6a02f64bb5fecb22dc550/README.md"

#: Download of photos from all over the Internet, resizing and packing into tars: most time goes into foreign servers'
#: answers, names' resolution and resizing. It draws nothing and knows no poses.
IMG2DATASET: tuple[Rate, ...] = (
    Rate(1350.0, 1, None, "18 million images in 3.7 h ('currently observed performance')", _README),
    Rate(1345.0, 1, None, "36 million images in 7 h 24 min (936 GB)", _README),
    Rate(1280.0, 1, None, "190 million images in 41 h (5 TB)", _README),
    Rate(
        10_000.0,
        10,
        16,
        "LAION-5B by Spark on c6i.4xlarge, 220 TB in a week; ten times 'each instance downloads at around "
        "1000 sample/s'",
        f"{_IMG2DATASET}/blob/7466e9e1c96d9664ad0bb6dc8b476f853e74afe3/dataset_examples/laion5B.md",
    ),
)
