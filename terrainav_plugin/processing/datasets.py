"""Algorithms that clean, split and export a dataset, or make its mosaic."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsProcessingFeedback,
    QgsProcessingOutputFile,
    QgsProcessingOutputFolder,
    QgsProcessingOutputString,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFolderDestination,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
    QgsProcessingParameterString,
)

from ...core.dataset.folder import AUTO, DEFAULT_ENTROPY, PARTS, SEED, SHARES
from ...core.errors import InvalidInput
from ...core.exports.kinds import BENCHMARKS, DATASETS, KINDS, LABEL_SETS, SEQUENCES, VIEWS, export_as
from ..dataset.splitting import HIGHEST_SEED, UTM, WIDEST_M, helps, outcome, split_methods, titles, undone_text
from ..i18n import number_text, tr
from .algorithm import Algorithm, AlgorithmRun, AlgorithmTexts, WorkFeedback, off_main_thread
from .choices import ChoiceParameter

if TYPE_CHECKING:
    from ...core.dataset.clean import Cleaned
    from ...core.dataset.split import Split, UndoneSplit
    from ...core.mosaic.orthomosaic import Orthomosaic

_MARK, _MOVE, _UNDO = "mark", "move", "undo"


class _OfDataset(Algorithm):
    """Base of cleaning and splitting: the parameters for the folder and a dry run."""

    GROUP = "datasets"

    def define(self) -> None:
        """Add the parameters and outputs."""
        self.add_dataset(tr("Of a capture, or of images with a meta_data.csv beside them."))
        self._define_own()
        self.add(QgsProcessingParameterBoolean("DRY_RUN", titles()["dry_run"], False), helps()["dry_run"])
        self.addOutput(QgsProcessingOutputFolder("FOLDER", tr("Dataset folder")))


class Clean(_OfDataset):
    """Mark or move images with too little detail."""

    NAME = "clean"

    def texts(self) -> AlgorithmTexts:
        """Return the texts of the algorithm."""
        return AlgorithmTexts(
            tr("Clean a dataset"),
            tr("Rejects low-detail images; deletes nothing."),
            tr("dataset,clean,entropy,filter,reject,training,machine learning"),
            (
                tr(
                    "Rejects images whose entropy is below a threshold. If a place has a roadmap image, "
                    "its entropy decides for all map types; otherwise each image's entropy does."
                ),
                tr(
                    "Nothing is deleted. mark notes in the table's column “rejected” why an image is "
                    "rejected; move also moves it, with the files that belong to it, to a folder "
                    "“rejected” beside the others; undo puts all back. A later capture into the folder "
                    "takes moved images into account."
                ),
                tr(
                    "The suggested threshold separates the entropies by Otsu's method. If they form one "
                    "group, nothing stands out, and the log says so."
                ),
            ),
        )

    def _define_own(self) -> None:
        # The maximum is the largest entropy of 256 grey levels.
        self.add(
            QgsProcessingParameterNumber(
                "ENTROPY",
                tr("Minimum entropy (bits)"),
                QgsProcessingParameterNumber.Type.Double,
                DEFAULT_ENTROPY,
                False,
                0.0,
                8.0,
            ),
            tr("Images below it are rejected; 0 to 8."),
        )
        self.add(
            ChoiceParameter("ACTION", tr("Action"), {one: one for one in (_MARK, _MOVE, _UNDO)}, _MARK),
            tr("Mark rejected images in the table, move them as well, or put all back."),
        )
        self.add(
            QgsProcessingParameterFolderDestination(
                "DIAGRAMS", tr("Folder of the diagrams"), optional=True, createByDefault=False
            ),
            tr("Histogram and bar plot of the entropies as PNG, for each map type; needs matplotlib."),
        )
        self.addOutput(QgsProcessingOutputFile("HISTOGRAM", tr("Histogram of the entropies")))
        self.addOutput(QgsProcessingOutputFile("BARS", tr("Entropy of each image")))
        self.add_numbers(
            {
                "IMAGES": tr("Images"),
                "REJECTED": tr("Images rejected, or put back"),
                "MOVED": tr("Images moved"),
                "SUGGESTED": tr("Suggested threshold (bits)"),
            }
        )

    def processed(self, run: AlgorithmRun) -> dict[str, Any]:
        """Clean."""
        from ...core.dataset.clean import clean, undo

        folder, action, dry_run = run.text("DATASET"), run.choice("ACTION"), run.flag("DRY_RUN")
        threshold, diagrams = run.number("ENTROPY"), run.text("DIAGRAMS")
        if diagrams and action == _UNDO:
            run.feedback.pushWarning(tr("Undo has no threshold: no diagrams are drawn."))

        def work(watch: WorkFeedback) -> tuple[Cleaned, ...]:
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

        cleaned = off_main_thread(work, run.feedback)
        for one in cleaned:
            run.feedback.pushInfo(
                tr("{map_type}: {rejected} of {images} images, {moved} moved, {returned} moved back.").format(
                    map_type=one.map_type,
                    rejected=number_text(one.rejected),
                    images=number_text(one.images),
                    moved=number_text(one.moved),
                    returned=number_text(one.returned),
                )
            )
        if action != _UNDO:
            _tell_of_thresholds(cleaned, run.feedback)
        if any(one.moved or one.returned for one in cleaned) and not dry_run:
            _tell_of_mosaics(Path(folder), run.feedback)
        suggested = next((one.suggested for one in cleaned if one.suggested is not None), None)
        return {
            "FOLDER": folder,
            "IMAGES": sum(one.images for one in cleaned),
            "REJECTED": sum(one.rejected for one in cleaned),
            "MOVED": sum(one.moved + one.returned for one in cleaned),
            **({} if suggested is None else {"SUGGESTED": suggested}),
            # The charts of the first map type; the others are in the same folder.
            **dict(zip(("HISTOGRAM", "BARS"), next((one.figures for one in cleaned if one.figures), ()))),
        }


def _tell_of_thresholds(cleaned: tuple[Cleaned, ...], feedback: QgsProcessingFeedback) -> None:
    """Warn if a threshold rejects too many images, or if the table has another kind of entropy."""
    for one in cleaned:
        if one.is_one_sided:
            feedback.pushWarning(
                tr("{map_type}: the threshold rejects {rejected} of {images} images.").format(
                    map_type=one.map_type,
                    rejected=number_text(one.rejected),
                    images=number_text(one.images),
                )
            )
        if one.suggested is not None and not one.groups:
            feedback.pushWarning(
                tr(
                    "{map_type}: the entropies form one group: nothing stands out, and the suggested threshold cuts "
                    "through its middle."
                ).format(map_type=one.map_type)
            )
    if any(one.measure != "grey" for one in cleaned):
        feedback.pushWarning(
            tr(
                "The table's entropies are not those of grey levels (the paper's equation 10), whose thresholds "
                "do not fit."
            )
        )


def _tell_of_mosaics(folder: Path, feedback: QgsProcessingFeedback) -> None:
    """Report mosaics that refer to moved images or lack restored images."""
    from ..dataset.mosaic import mosaic_names

    mosaics = mosaic_names(folder)
    if mosaics:
        feedback.pushWarning(
            tr(
                "{names}: does not yet reflect the moved images; to update it, run “Make an orthomosaic”, or choose "
                "“Open dataset folder” in the panel's Missions menu."
            ).format(names=", ".join(mosaics))
        )


class SplitAlgorithm(_OfDataset):
    """Divide images into training, validation and test parts."""

    NAME = "split"

    def texts(self) -> AlgorithmTexts:
        """Return the texts of the algorithm."""
        return AlgorithmTexts(
            tr("Split a dataset"),
            tr("Divides images into training, validation and test, and scales their positions."),
            tr("dataset,split,training,validation,test,blocks,labels,machine learning"),
            (
                tr(
                    "Writes the part of each image to the column “split” of the tables: train, validation or test. "
                    "Images of one place are in the same part in all map types; failed and rejected ones are in none."
                ),
                tr(
                    "shuffled follows a hash of the seed and the image's name, the same on every computer; in-order "
                    "follows the table; blocks divides the ground, so that none is in images of two parts: images in "
                    "between are marked “gap”, as are those that see the horizon. auto takes blocks where images "
                    "overlap, and shuffles otherwise."
                ),
                tr(
                    "labels.json has the frame and the scaler of the images' positions, fitted on the training part: "
                    "utm is the zone of the middle, mission a plane about the middle."
                ),
            ),
        )

    def _define_own(self) -> None:
        number, title, text = QgsProcessingParameterNumber.Type, titles(), helps()
        self.add(ChoiceParameter("HOW", title["how"], split_methods(), AUTO), text["how"])
        add_shares(self)
        self.add(
            QgsProcessingParameterNumber("SEED", title["seed"], number.Integer, SEED, False, 0, HIGHEST_SEED),
            text["seed"],
        )
        self.add(
            QgsProcessingParameterNumber("BLOCK", title["block"], number.Double, None, True, 0.0, WIDEST_M),
            text["block"],
        )
        add_gap(self, text["gap"])
        self.add(QgsProcessingParameterString("FRAME", title["frame"], UTM), text["frame"])
        self.add(QgsProcessingParameterBoolean("UNDO", title["undo"], False), text["undo"])
        self.add_numbers(
            {
                "TRAIN_IMAGES": tr("Training images"),
                "VALIDATION_IMAGES": tr("Validation images"),
                "TEST_IMAGES": tr("Test images"),
                "GAP_IMAGES": tr("Images in no part"),
            }
        )
        self.addOutput(QgsProcessingOutputString("LABELS", tr("Frame and scaler of the labels (JSON)")))

    def processed(self, run: AlgorithmRun) -> dict[str, Any]:
        """Split, or undo the last split."""
        from ...core.dataset.split import split, undo_split

        folder, shares = run.text("DATASET"), read_shares(run)
        if run.flag("UNDO"):

            def restore(_: WorkFeedback) -> UndoneSplit:
                return undo_split(folder, dry_run=run.flag("DRY_RUN"))

            undone = off_main_thread(restore, run.feedback)
            run.feedback.pushInfo(undone_text(undone))
            return {
                "FOLDER": folder,
                **{f"{part.upper()}_IMAGES": count for part, count in (undone.parts or {}).items()},
            }
        options = {
            "seed": run.whole("SEED"),
            "how": run.choice("HOW"),
            "block_m": run.number("BLOCK") if run.is_given("BLOCK") else None,
            "gap_m": run.number("GAP"),
            "frame": run.text("FRAME"),
            "dry_run": run.flag("DRY_RUN"),
        }

        def work(watch: WorkFeedback) -> Split:
            return split(folder, shares, **options, progress=watch.progress)

        made = off_main_thread(work, run.feedback)
        for line in outcome(made):
            (run.feedback.pushWarning if line.warns else run.feedback.pushInfo)(line.text)
        return {
            "FOLDER": folder,
            **{f"{part.upper()}_IMAGES": count for part, count in made.images.items()},
            "GAP_IMAGES": made.gap + made.unknown,
            "LABELS": json.dumps(json.loads(made.labels.to_json())),
        }


class Export(Algorithm):
    """Export a dataset or benchmark to a format of another program."""

    NAME = "export"
    GROUP = "datasets"

    def texts(self) -> AlgorithmTexts:
        """Return the texts of the algorithm."""
        return AlgorithmTexts(
            tr("Export a dataset or benchmark"),
            tr("Writes a dataset or a benchmark in a format of other programs."),
            tr(
                "dataset,export,colmap,nerfstudio,parquet,hugging face,croissant,stac,coco,yolo,benchmark,"
                "university-1652"
            ),
            (
                tr(
                    "Camera frames become a COLMAP model, nerfstudio's transforms or a trajectory; the images stay "
                    "where they are. Any dataset becomes tables of Parquet, folders for Hugging Face's datasets, a "
                    "description of its files, or STAC items and their collection. A dataset with labels becomes "
                    "a training set in the layout of COCO or YOLO, and a benchmark the layout of a published one."
                ),
            ),
        )

    def define(self) -> None:
        """Add the parameters and outputs."""
        self.add_dataset(tr("Of a capture, or of a benchmark."))
        self.add(
            ChoiceParameter("FORMAT", tr("Format"), KINDS, next(iter(KINDS))),
            tr(
                "Of camera frames: {views}. Of any dataset: {datasets}. Of labels of pixels: {labels}. "
                "Of a sequence: {sequences}. Of a benchmark: {benchmarks}."
            ).format(
                **{
                    name: ", ".join(kinds)
                    for name, kinds in (
                        ("views", VIEWS),
                        ("datasets", DATASETS),
                        ("labels", LABEL_SETS),
                        ("sequences", SEQUENCES),
                        ("benchmarks", BENCHMARKS),
                    )
                }
            ),
        )
        self.add(
            QgsProcessingParameterString("MAP_TYPE", tr("Map type"), optional=True),
            tr("The one to export, of several. If empty: satellite, or all for formats of datasets."),
        )
        self.add(
            QgsProcessingParameterFolderDestination(
                "FOLDER", tr("Folder of the export"), optional=True, createByDefault=False
            ),
            tr("New or empty; if left out, parquet, croissant and stac are written into the dataset's folder."),
        )
        self.add_numbers({"COUNT": tr("Images, files or queries written")})

    def processed(self, run: AlgorithmRun) -> dict[str, Any]:
        """Export."""
        folder, target, kind = run.text("DATASET"), run.text("FOLDER") or None, run.choice("FORMAT")
        map_type = run.text("MAP_TYPE").strip() or None
        done = off_main_thread(lambda watch: export_as(folder, target, kind, map_type, watch.progress), run.feedback)
        return {"FOLDER": target or folder, "COUNT": done.written}


def add_shares(algorithm: Algorithm) -> None:
    """Add parameters for the shares of training, validation and test."""
    title, text = titles(), helps()
    for part, share in zip(PARTS, SHARES):
        algorithm.add(
            QgsProcessingParameterNumber(
                part.upper(), title[part], QgsProcessingParameterNumber.Type.Double, share, False, 0.0, 1.0
            ),
            text[part],
        )


def read_shares(run: AlgorithmRun) -> tuple[float, float, float]:
    """Read the shares of the parameters."""
    training, validation, test = (run.number(part.upper()) for part in PARTS)
    return training, validation, test


def add_gap(algorithm: Algorithm, help_text: str) -> None:
    """Add a parameter for the distance between parts."""
    algorithm.add(
        QgsProcessingParameterNumber(
            "GAP",
            titles()["gap"],
            QgsProcessingParameterNumber.Type.Double,
            0.0,
            False,
            0.0,
            WIDEST_M,
        ),
        help_text,
    )


class MakeMosaic(Algorithm):
    """Make one orthophoto from all images."""

    NAME, GROUP = "mosaic", "datasets"

    def texts(self) -> AlgorithmTexts:
        """Return the texts of the algorithm."""
        return AlgorithmTexts(
            tr("Make an orthomosaic"),
            tr("One orthophoto of all images of a dataset, also of turned and tilted ones and over relief."),
            tr("dataset,mosaic,orthophoto,orthomosaic,orthorectify,nadir,tilted,oblique,relief"),
            (
                tr(
                    "Turned and tilted images are orthorectified by the exact camera, over level ground or the "
                    "mission's relief. Each pixel comes from the image that sees its ground most nearly from straight "
                    "above: at one height of flight, the one whose nadir is nearest. Ground that relief hides from an "
                    "image is taken from another that sees it."
                ),
                tr(
                    "Images that look straight down with north at the top keep their pixels. Failed and "
                    "rejected images are left out. Ground that no image shows is transparent."
                ),
            ),
        )

    def define(self) -> None:
        """Add the parameters and outputs."""
        self.add_dataset(tr("Of a capture."))
        self.add(
            QgsProcessingParameterString("MAP_TYPE", tr("Map type"), "", optional=True),
            tr("Such as satellite; the dataset's first one if empty."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "GSD",
                tr("Ground sample distance (metres)"),
                QgsProcessingParameterNumber.Type.Double,
                None,
                True,
                0.0,
            ),
            tr("If empty, that of the images, or a larger one where the mosaic would have over 268 million pixels."),
        )
        self.add(
            QgsProcessingParameterRasterDestination("OUTPUT", tr("Orthomosaic")),
            tr("A GeoTIFF with overviews."),
        )
        self.add_numbers(
            {
                "IMAGES": tr("Images"),
                "USED": tr("Images in the mosaic"),
                "WIDTH": tr("Width (px)"),
                "HEIGHT": tr("Height (px)"),
                "RESOLUTION": tr("Ground sample distance (metres)"),
            }
        )

    def processed(self, run: AlgorithmRun) -> dict[str, Any]:
        """Make the orthomosaic."""
        from ..dataset.rectify import write_mosaic
        from ..sources import mission_heights

        folder, map_type = Path(run.text("DATASET")), run.text("MAP_TYPE").strip()
        target = Path(run.algorithm.parameterAsOutputLayer(run.parameters, "OUTPUT", run.context))
        if target.suffix.lower() not in (".tif", ".tiff"):
            raise InvalidInput(tr("mosaic {path}: must be a GeoTIFF (.tif)").format(path=target))
        gsd_m = run.number("GSD") if run.is_given("GSD") else None

        def work(watch: WorkFeedback) -> Orthomosaic:
            return write_mosaic(folder, map_type, target, mission_heights, watch.progress, gsd_m)

        made = off_main_thread(work, run.feedback)
        run.feedback.pushInfo(
            tr("{map_type}: {used} of {images} images, {width} × {height} px of {gsd} m.").format(
                map_type=made.map_type,
                used=number_text(made.used),
                images=number_text(made.images),
                width=number_text(made.width_px),
                height=number_text(made.height_px),
                gsd=number_text(made.gsd_m_per_px, ".3g"),
            )
        )
        return {
            "OUTPUT": str(target),
            "IMAGES": made.images,
            "USED": made.used,
            "WIDTH": made.width_px,
            "HEIGHT": made.height_px,
            "RESOLUTION": made.gsd_m_per_px,
        }
