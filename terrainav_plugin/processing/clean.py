"""Algorithm: a dataset cleaned of images with too little to see."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingOutputFile,
    QgsProcessingOutputFolder,
    QgsProcessingOutputNumber,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFile,
    QgsProcessingParameterFolderDestination,
    QgsProcessingParameterNumber,
)

from ..i18n import number_text, tr
from .algorithm import Algorithm, Watch, paragraphs, run_in_background

if TYPE_CHECKING:
    from ...core.dataset.clean import Cleaned

_MARK, _MOVE, _UNDO = "mark", "move", "undo"
#: The paper's threshold, and the most that 256 grey levels can have.
_ENTROPY, _HIGHEST = 2.1, 8.0


class Clean(Algorithm):
    """Images with too little to see, marked or moved."""

    NAME, GROUP = "clean", "datasets"

    def displayName(self) -> str:
        """Title."""
        return tr("Clean a dataset")

    def shortDescription(self) -> str:
        """Tooltip."""
        return tr("Rejects images with too little to see; deletes nothing.")

    def tags(self) -> list[str]:
        """Words that it is found by."""
        return tr("dataset,clean,entropy,filter,reject,training,machine learning").split(",")

    def shortHelpString(self) -> str:
        """Help."""
        return paragraphs(
            tr(
                "Rejects images whose entropy is below a threshold. If a place has a roadmap image, its "
                "entropy decides for all map types; otherwise each image's own entropy does."
            ),
            tr(
                "Nothing is deleted. mark notes in the table's column “rejected” why an image is rejected; move also "
                "moves it, with the files that belong to it, to a folder “rejected” beside the others; undo puts all "
                "back. A later capture into the folder knows what was moved."
            ),
            tr("The suggested threshold parts the entropies by Otsu's method."),
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
            QgsProcessingParameterNumber(
                "ENTROPY",
                tr("Least entropy (bits)"),
                QgsProcessingParameterNumber.Type.Double,
                _ENTROPY,
                False,
                0.0,
                _HIGHEST,
            ),
            tr("Images below it are rejected; 0 to 8."),
        )
        self.add(
            QgsProcessingParameterEnum(
                "ACTION",
                tr("What to do"),
                options=[_MARK, _MOVE, _UNDO],
                defaultValue=_MARK,
                usesStaticStrings=True,
            ),
            tr("Mark rejected images in the table, move them as well, or put all back."),
        )
        self.add(QgsProcessingParameterBoolean("DRY_RUN", tr("Only count"), False), tr("Nothing is changed."))
        self.add(
            QgsProcessingParameterFolderDestination(
                "DIAGRAMS", tr("Folder of the diagrams"), optional=True, createByDefault=False
            ),
            tr("Histogram and bar plot of the entropies as PNG, for each map type; needs matplotlib."),
        )
        self.addOutput(QgsProcessingOutputFolder("FOLDER", tr("Dataset folder")))
        self.addOutput(QgsProcessingOutputFile("HISTOGRAM", tr("Histogram of the entropies")))
        self.addOutput(QgsProcessingOutputFile("BARS", tr("Entropy of each image")))
        for name, title in (
            ("IMAGES", tr("Images")),
            ("REJECTED", tr("Images rejected, or put back")),
            ("MOVED", tr("Images moved")),
            ("SUGGESTED", tr("Suggested threshold (bits)")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, title))

    def processed(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Clean."""
        from ...core.dataset.clean import clean, undo

        folder = self.parameterAsString(parameters, "DATASET", context)
        threshold = self.parameterAsDouble(parameters, "ENTROPY", context)
        action = self.parameterAsEnumString(parameters, "ACTION", context)
        dry_run = self.parameterAsBool(parameters, "DRY_RUN", context)
        diagrams = self.parameterAsString(parameters, "DIAGRAMS", context)
        if diagrams and action == _UNDO:
            feedback.pushWarning(tr("Undo has no threshold: no diagrams are drawn."))

        def work(watch: Watch) -> tuple[Cleaned, ...]:
            if action == _UNDO:
                return undo(folder, dry_run=dry_run, progress=watch.progress)
            return clean(
                folder,
                threshold,
                move=action == _MOVE,
                dry_run=dry_run,
                plot=diagrams or None,
                progress=watch.progress,
            )

        cleaned = run_in_background(work, feedback)
        for one in cleaned:
            feedback.pushInfo(
                tr("{map_type}: {rejected} of {images} images, {moved} moved, {returned} moved back.").format(
                    map_type=one.map_type,
                    rejected=number_text(one.rejected),
                    images=number_text(one.images),
                    moved=number_text(one.moved),
                    returned=number_text(one.returned),
                )
            )
        if any(one.moved or one.returned for one in cleaned) and not dry_run:
            _tell_of_mosaics(Path(folder), feedback)
        suggested = next((one.suggested for one in cleaned if one.suggested is not None), None)
        return {
            "FOLDER": folder,
            "IMAGES": sum(one.images for one in cleaned),
            "REJECTED": sum(one.rejected for one in cleaned),
            "MOVED": sum(one.moved + one.returned for one in cleaned),
            **({} if suggested is None else {"SUGGESTED": suggested}),
            # Of the map type that comes first: the others lie beside it.
            **dict(zip(("HISTOGRAM", "BARS"), next((one.figures for one in cleaned if one.figures), ()))),
        }


def _tell_of_mosaics(folder: Path, feedback: QgsProcessingFeedback) -> None:
    """Say that a mosaic still names images that are elsewhere now, or lacks some that are back."""
    mosaics = sorted(path.name for path in folder.glob("*.vrt"))
    if mosaics:
        feedback.pushWarning(
            tr(
                "{names}: does not yet reflect the moved images; to update it, choose “Open dataset folder” "
                "in the panel's Missions menu."
            ).format(names=", ".join(mosaics))
        )
