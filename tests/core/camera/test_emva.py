"""The sensor against `emva1288` 1.0.2, the program of the committee of EMVA 1288, in the peers' environment."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy import constants
from terrainav.core.camera.sensor import Detector, read_out

from tests.support.peers import told_by_peers

STEPS, STACK = 50, 48
PEER_CODE = """
import json, logging, sys
import numpy as np
# It is written for numpy 1, whose names these are.
np.asfarray = lambda values: np.asarray(values, float)
from emva1288.process.data import Data1288
from emva1288.process.loader import LoadImageData
from emva1288.process.parser import ParseEmvaDescriptorFile
from emva1288.process.results import Results1288
logging.disable(logging.CRITICAL)
parsed = ParseEmvaDescriptorFile(sys.argv[1])
found = Results1288(Data1288(LoadImageData(parsed.images, fload=np.load).data).data)
print(json.dumps([float(one) for one in (found.K, found.QE, found.sigma_d, found.PRNU1288, found.DSNU1288)]))
"""


@pytest.mark.thorough
@pytest.mark.parametrize(
    "detector",
    [
        Detector(2.25, 0.8847, 2_183.0, 1.954, 1.473, 1.3, 0.008, 1.673, 240.0, 12),
        Detector(4.5, 0.73, 25_000.0, 10.0, 50.0, 9.0, 0.012, 0.16, 60.0, 12),
        Detector(5.0, 0.5, 2_000.0, 20.0, 0.0, 15.0, 0.02, 0.11, 16.0, 8),
    ],
    ids=["small well", "large well", "8 bits"],
)
def test_the_program_of_the_standard_finds_the_figures(detector, tmp_path):
    size = 420, 560
    # 50,000 lux on the sensor: photons by watts at 555 nm.
    photons_per_s = 50_000.0 / 683.0 / (constants.h * constants.c / 555e-9) * (detector.pixel_um * 1e-6) ** 2
    well_e = min(detector.full_well_e, (detector.most_dn - detector.black_level_dn) / detector.gain_dn_per_e)
    full_s = well_e / detector.quantum_efficiency / photons_per_s
    lines = ["v 4.0", f"n {detector.bits} {size[1]} {size[0]}"]
    steps = [(full_s * 1.1 * step / STEPS, 2) for step in range(1, STEPS + 1)]
    for time_s, count in [*steps, (full_s / 2.0, STACK)]:
        for head, lux in (
            (f"b {time_s * 1e9:.3f} {photons_per_s * time_s:.6f}", 50_000.0),
            (f"d {time_s * 1e9:.3f}", 0.0),
        ):
            lines.append(head)
            for number in range(count):
                name = f"{time_s:.9f}-{lux:.0f}-{count}-{number}"
                exposure = np.full(size, lux * time_s, np.float32)
                np.save(tmp_path / f"{name}.npy", read_out(detector, exposure, time_s, 1, name))
                lines.append(f"i {name}.npy")
    (tmp_path / "flats.txt").write_text("\n".join((*lines, "")))
    gain, efficiency, dark_e, prnu, dsnu_e = json.loads(told_by_peers("-c", PEER_CODE, tmp_path / "flats.txt"))
    # Spatial variances have a relative error of sqrt(2/n), and so has the temporal noise that is left in mean images.
    half_e = well_e / 2.0
    left = half_e / STACK / (detector.prnu * half_e) ** 2
    assert 5.0 * math.sqrt(2.0 / math.prod(size)) / 2.0 * (1.0 + left) < 0.01
    assert gain == pytest.approx(detector.gain_dn_per_e, rel=0.01)
    assert efficiency / 100.0 == pytest.approx(detector.quantum_efficiency, rel=0.01)
    assert dark_e == pytest.approx(detector.read_noise_e, rel=0.01)
    assert prnu / 100.0 == pytest.approx(detector.prnu, rel=0.01)
    assert dsnu_e == pytest.approx(detector.dsnu_e, rel=0.03)
