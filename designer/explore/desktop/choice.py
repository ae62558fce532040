"""A list to choose from that takes no more room when its entries become longer."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtWidgets import QComboBox


class Choice(QComboBox):
    """As wide as so many letters; its entries are read in full where it is opened."""

    def __init__(self, name: str, letters: int, *texts: str) -> None:
        super().__init__()
        self.setObjectName(name)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setMinimumContentsLength(letters)
        self.addItems(texts)

    def refill(self, texts: Sequence[str]) -> None:
        """Offer these texts; the present one stays where it still is among them."""
        if [self.itemText(k) for k in range(self.count())] == list(texts):
            return
        present = self.currentText()
        self.blockSignals(True)
        self.clear()
        self.addItems(texts)
        self.setCurrentText(present)  # of another text nothing happens: the first one stays
        self.blockSignals(False)

    def showPopup(self) -> None:
        """Open the list as wide as its longest entry."""
        self.view().setMinimumWidth(self.view().sizeHintForColumn(0) + 24)
        super().showPopup()
