"""Algorithm: a dataset divided into training, validation and test."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingOutputFolder,
    QgsProcessingOutputNumber,
    QgsProcessingOutputString,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFile,
    QgsProcessingParameterNumber,
    QgsProcessingParameterString,
)

from ..i18n import number_text, tr
from .algorithm import Algorithm, Watch, paragraphs, run_in_background

if TYPE_CHECKING:
    from ...core.dataset.split import Split as Made

_WAYS = ["shuffled", "in-order", "blocks"]
#: The paper's.
_SEED, _SHARES = 2024, (0.8, 0.1, 0.1)
_HIGHEST_SEED = 2**31 - 1
_WIDEST_M = 1_000_000.0


class Split(Algorithm):
    """Images given to the training, the validation or the test part."""

    NAME, GROUP = "split", "datasets"

    def displayName(self) -> str:
        """Title."""
        return tr("Split a dataset")

    def shortDescription(self) -> str:
        """Tooltip."""
        return tr("Divides images into training, validation and test, and scales their positions.")

    def tags(self) -> list[str]:
        """Words that it is found by."""
        return tr("dataset,split,training,validation,test,blocks,labels,machine learning").split(",")

    def shortHelpString(self) -> str:
        """Help."""
        return paragraphs(
            tr(
                "Writes the part of each image to the column “split” of the tables: train, validation or test. Images "
                "of one place are in the same part in all map types; failed and rejected ones are in none."
            ),
            tr(
                "shuffled follows a hash of the seed and the image's name, the same on every computer; in-order "
                "follows the table; blocks divides the ground, so that none is in images of two parts: images in "
                "between are marked “gap”, as are those that see the horizon."
            ),
            tr(
                "labels.json has the frame and the scaler of the images' positions, fitted on the training part: utm "
                "is the zone of the middle, mission a plane about the middle."
            ),
        )

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:  # noqa: ARG002  QGIS passes it
        """Add parameters and outputs."""
        self.add(
            QgsProcessingParameterFile(
                "DATASET", tr("Dataset folder"), QgsProcessingParameterFile.Behavior.Folder
            ),
            tr("Of a capture, or of images with a meta_data.csv beside them."),
        )
        self.add(
            QgsProcessingParameterEnum(
                "HOW", tr("How to split"), options=_WAYS, defaultValue=_WAYS[0], usesStaticStrings=True
            ),
            tr("By a hash of seed and name, in the table's order, or by blocks of ground."),
        )
        number = QgsProcessingParameterNumber.Type
        for name, title, share in zip(
            ("TRAIN", "VALIDATION", "TEST"),
            (tr("Share of training"), tr("Share of validation"), tr("Share of test")),
            _SHARES,
        ):
            self.add(
                QgsProcessingParameterNumber(name, title, number.Double, share, False, 0.0, 1.0),
                tr("The three shares add up to 1."),
            )
        self.add(
            QgsProcessingParameterNumber("SEED", tr("Seed"), number.Integer, _SEED, False, 0, _HIGHEST_SEED),
            tr("The same seed gives the same split."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "BLOCK", tr("Side of the blocks (m)"), number.Double, None, True, 0.0, _WIDEST_M
            ),
            tr("With blocks only. If empty, a size is found that gives parts close to the shares."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "GAP", tr("Gap between parts (m)"), number.Double, 0.0, False, 0.0, _WIDEST_M
            ),
            tr("With blocks only: minimum distance between the ground of two parts."),
        )
        self.add(
            QgsProcessingParameterString("FRAME", tr("Frame of the labels"), "utm"),
            tr("utm, mercator, mission, or a projected system in metres such as EPSG:32616."),
        )
        self.add(QgsProcessingParameterBoolean("DRY_RUN", tr("Only count"), False), tr("Nothing is changed."))
        self.addOutput(QgsProcessingOutputFolder("FOLDER", tr("Dataset folder")))
        for name, title in (
            ("TRAIN_IMAGES", tr("Training images")),
            ("VALIDATION_IMAGES", tr("Validation images")),
            ("TEST_IMAGES", tr("Test images")),
            ("GAP_IMAGES", tr("Images in no part")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, title))
        self.addOutput(QgsProcessingOutputString("LABELS", tr("Frame and scaler of the labels (JSON)")))

    def processed(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Split."""
        from ...core.dataset.split import split

        folder = self.parameterAsString(parameters, "DATASET", context)
        shares = [
            self.parameterAsDouble(parameters, name, context) for name in ("TRAIN", "VALIDATION", "TEST")
        ]
        how = self.parameterAsEnumString(parameters, "HOW", context)
        seed = self.parameterAsInt(parameters, "SEED", context)
        block_m = (
            None if parameters.get("BLOCK") is None else self.parameterAsDouble(parameters, "BLOCK", context)
        )
        gap_m = self.parameterAsDouble(parameters, "GAP", context)
        frame = self.parameterAsString(parameters, "FRAME", context)
        dry_run = self.parameterAsBool(parameters, "DRY_RUN", context)

        def work(_: Watch) -> Made:
            return split(
                folder,
                shares,
                seed=seed,
                how=how,
                block_m=block_m,
                gap_m=gap_m,
                frame=frame,
                dry_run=dry_run,
            )

        made = run_in_background(work, feedback)
        _tell(made, feedback)
        return {
            "FOLDER": folder,
            **{f"{part.upper()}_IMAGES": count for part, count in made.images.items()},
            "GAP_IMAGES": made.gap + made.unknown,
            "LABELS": json.dumps(json.loads(made.labels.to_json())),
        }


def _tell(made: Made, feedback: QgsProcessingFeedback) -> None:
    """Say what shares are reached, and what is in no part."""
    for part, share in made.shares.items():
        feedback.pushInfo(
            tr("{part}: {images} images ({share} %).").format(
                part=part, images=number_text(made.images[part]), share=number_text(100.0 * share, ".1f")
            )
        )
    if made.gap:
        feedback.pushInfo(
            tr("{images} images are in no part: too near to another part's ground.").format(
                images=number_text(made.gap)
            )
        )
    if made.unknown:
        feedback.pushWarning(
            tr("{images} images are in no part: they see the horizon or a pole.").format(
                images=number_text(made.unknown)
            )
        )
    zones = made.labels.frame.zones
    if len(zones) > 1:
        feedback.pushWarning(
            tr(
                "The images lie in {count} UTM zones ({zones}); one frame is for all of them: {frame}."
            ).format(count=len(zones), zones=", ".join(zones), frame=made.labels.frame.crs)
        )
