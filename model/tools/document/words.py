"""The words of the data sheet in English and German."""

import re
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from coilset.model.core.results.records.labels import plain

Language = Literal["en", "de"]

GERMAN = {
    "Compression spring": "Druckfeder",
    "Extension spring": "Zugfeder",
    "Torsion spring": "Schenkelfeder",
    "customer": "Kunde",
    "order": "Auftrag",
    "part": "Teil",
    "date": "Datum",
    "revision": "Änderung",
    "scale {}": "Maßstab {}",
    "page {} of {}": "Seite {} von {}",
    "formula": "Formel",
    "run": "Lauf",
    "Calculated by the formulas of {}, before a run": "Berechnet nach {}, vor einem Lauf",
    "Results of the run {}, beside the formulas of {}": "Ergebnisse des Laufs {}, daneben die Formeln nach {}",
    "Design": "Ausführung",
    "wire": "Draht",
    "coiling direction": "Windungsrichtung",
    "coiled right-hand": "rechts gewickelt",
    "coiled left-hand": "links gewickelt",
    "right": "rechts",
    "left": "links",
    "ends": "Federenden",
    "open": "offen",
    "closed": "angelegt",
    "closed and ground": "angelegt und geschliffen",
    "mixed": "verschieden",
    "bottom hook": "Öse unten",
    "top hook": "Öse oben",
    "german": "deutsche Öse",
    "english": "englische Öse",
    "side": "seitliche Öse",
    "bottom arm": "Schenkel unten",
    "top arm": "Schenkel oben",
    "tangential": "tangential",
    "radial": "radial",
    "axial": "axial",
    "straight part": "gerade Länge",
    "bent outwards by": "nach außen gebogen um",
    "bent inwards by": "nach innen gebogen um",
    "bent away by": "axial vom Körper weg gebogen um",
    "bent back by": "axial über den Körper gebogen um",
    "straight behind the bend": "gerade Länge dahinter",
    "total turns nt": "Gesamtwindungen nt",
    "outer diameter De": "Außendurchmesser De",
    "inner diameter Di": "Innendurchmesser Di",
    "Dimensions": "Abmessungen",
    "wire diameter d": "Drahtdurchmesser d",
    "wire height d": "Drahthöhe d",
    "wire width": "Drahtbreite",
    "torsion constant J": "Torsionskonstante J",
    "section modulus W": "Widerstandsmoment W",
    "mean diameter D": "mittlerer Durchmesser D",
    "spring index w": "Wickelverhältnis w",
    "active turns n": "federnde Windungen n",
    "free length L0": "ungespannte Länge L0",
    "wire length l": "Drahtlänge l",
    "mass m": "Masse m",
    "growth of D to block": "Zunahme von D bis Block",
    "Extension spring, EN 13906-2": "Zugfeder, EN 13906-2",
    "with hooks": "mit Ösen",
    "initial tension F0": "Vorspannkraft F0",
    "stress τ0": "Spannung τ0",
    "all others": "alle anderen",
    "all": "alle",
    "Torsion spring, EN 13906-3": "Schenkelfeder, EN 13906-3",
    "with clamped arms": "mit eingespannten Schenkeln",
    "with an arm on a point": "mit einem Schenkel auf einem Punkt",
    "lever of its force F": "Hebelarm seiner Kraft F",
    "force on the arm F": "Kraft am Schenkel F",
    "stress factor q": "Spannungsbeiwert q",
    "bending stress of hooks": "Biegespannung der Ösen",
    "permissible stress": "zulässige Spannung",
    "torque at {}°": "Moment bei {}°",
    "bending stress σ": "Biegespannung σ",
    "at the inside σq": "an der Innenseite σq",
    "inner diameter": "Innendurchmesser",
    "Rate, block and buckling": "Federrate, Block und Knicken",
    "rate R": "Federrate R",
    "R of a rising wire": "R des steigenden Drahtes",
    "block length Lc": "Blocklänge Lc",
    "block of the geometry": "Blocklänge der Geometrie",
    "force at block Fc": "Blockkraft Fc",
    "travel to buckling": "Knickfederweg",
    "Stresses at block": "Spannungen bei Block",
    "stress τc": "Spannung τc",
    "stress correction k": "Korrekturbeiwert k",
    "corrected stress τkc": "korrigierte Spannung τkc",
    "tensile strength Rm": "Zugfestigkeit Rm",
    "minimum tensile strength Rm": "Mindestzugfestigkeit Rm",
    "allowed at block": "zulässig bei Block",
    "Working lengths": "Arbeitslängen",
    "minimum sum of gaps Sa": "Mindestabstand Sa",
    "smallest length Ln": "kleinste Länge Ln",
    "force at {} mm": "Kraft bei {} mm",
    "stress τ": "Spannung τ",
    "corrected stress τk": "korrigierte Spannung τk",
    "sum of gaps": "Summe der Abstände",
    "Frequency and energy": "Frequenz und Energie",
    "natural frequency": "Eigenfrequenz",
    "work to block": "Federarbeit bis Block",
    "Endurance": "Dauerfestigkeit",
    "lower stress τk1": "Unterspannung τk1",
    "range τkh": "Hubspannung τkh",
    "permissible stress range": "zulässige Hubspannung",
    "Tolerances, EN 15800 grade {}": "Toleranzen, EN 15800 Gütegrad {}",
    "mean diameter ±": "mittlerer Durchmesser ±",
    "free length ±": "ungespannte Länge ±",
    "force at {} mm ±": "Kraft bei {} mm ±",
    "lean e1": "Schiefstellung e1",
    "parallelism e2": "Parallelität e2",
    "Limits": "Grenzen",
    "Finished spring": "Fertige Feder",
    "set": "Setzbetrag",
    "residual shear stress, inside of the coil": "Schubeigenspannung, innen",
    "maximum force": "größte Kraft des Laufs",
    "force where the coils close": "Kraft beim Anliegen der Windungen",
    "maximum torque": "größtes Moment des Laufs",
    "residual bending stress, inside of the coil": "Biegeeigenspannung, innen",
    "greatest shear stress at {} mm": "größte Schubspannung bei {} mm",
    "safety against the allowable at {} mm": "Sicherheit gegen zul. bei {} mm",
    "Fatigue of the run": "Ermüdung nach dem Lauf",
    "safety, {}": "Sicherheit, {}",
    "cycles that 10, 50, 90 % do not survive": "Lastspiele, die 10, 50, 90 % nicht erreichen",
    "Force over travel": "Kraft über Federweg",
    "travel, mm": "Federweg, mm",
    "force, N": "Kraft, N",
    "Torque over rotation": "Moment über Drehwinkel",
    "rotation, °": "Drehwinkel, °",
    "torque, N mm": "Moment, N mm",
    "by the formula": "nach Formel",
    "by the run": "nach dem Lauf",
    "working points": "Arbeitspunkte",
    "limits": "Grenzen",
    "Goodman diagram": "Goodman-Diagramm",
    "lower corrected stress τk1, MPa": "korrigierte Unterspannung τk1, MPa",
    "upper corrected stress τk2, MPa": "korrigierte Oberspannung τk2, MPa",
    "permitted, {} cycles, as coiled, preset springs": "zulässig, {} Lastspiele, ungestrahlt, gesetzt",
    "permitted, {} cycles, as coiled, springs not preset": "zulässig, {} Lastspiele, ungestrahlt, ungesetzt",
    "permitted, {} cycles, as coiled, presetting not stated": "zulässig, {} Lastspiele, ungestrahlt, Setzen offen",
    "permitted, {} cycles, shot peened, preset springs": "zulässig, {} Lastspiele, kugelgestrahlt, gesetzt",
    "permitted, {} cycles, shot peened, springs not preset": "zulässig, {} Lastspiele, kugelgestrahlt, ungesetzt",
    "permitted, {} cycles, shot peened, presetting not stated": "zulässig, {} Lastspiele, kugelgestrahlt, Setzen offen",
    "at rest, τk2 = τk1": "ruhend, τk2 = τk1",
    "working cycle, nominal": "Lastspiel, Nennspannung",
    "with the computed residual {}": "mit berechneter Eigenspannung {}",
    "check": "Nachweis",
    "verdict": "Urteil",
    "value": "Wert",
    "limit": "Grenze",
    "reserve": "Reserve",
    "limit from": "Grenze nach",
    "permitted": "zulässig",
    "not permitted": "nicht zulässig",
    "not known": "nicht bekannt",
    "shortest length, mm": "kleinste Länge, mm",
    "sum of gaps, mm": "Summe der Windungsabstände, mm",
    "τ at solid, MPa": "τ bei Blocklänge, MPa",
    "τ at {} mm, MPa": "τ bei {} mm, MPa",
    "travel before buckling, mm": "Federweg vor dem Knicken, mm",
    "travel before buckling, to block, mm": "Federweg vor dem Knicken, bis Block, mm",
    "fatigue, τk2, MPa": "Dauerfestigkeit, τk2, MPa",
    "temperature, °C": "Temperatur, °C",
    "index D/d": "Wickelverhältnis D/d",
    "tolerance": "Toleranz",
    "tolerance, by D/d": "Toleranz, nach D/d",
    "tolerance of the load": "Toleranz der Last",
    "τ of the coils {}, MPa": "τ der Windungen, {}, MPa",
    "σ of the hooks {}, MPa": "σ der Ösen, {}, MPa",
    "τ0 of the initial tension, MPa": "τ0 der Vorspannkraft, MPa",
    "σ of the coils at {}°, MPa": "σ der Windungen bei {}°, MPa",
    "σ of the legs, MPa": "σ der Schenkel, MPa",
    "inner diameter on the arbor, mm": "Innendurchmesser auf dem Dorn, mm",
    "outer diameter in the sleeve, mm": "Außendurchmesser in der Hülse, mm",
    "Permitted by all checks.": "Nach allen Nachweisen zulässig.",
    "Remarks": "Hinweise (englisch)",
}
"""Texts of the sheet by the English ones; {} stands for a number or name."""


@dataclass(frozen=True)
class Words:
    """Texts and numbers of one language."""

    language: Language = "en"

    def __call__(self, text: str) -> str:
        """A text in this language; one that is not in the table as it is."""
        if self.language == "en":
            return text
        bare = text.strip()
        if bare in GERMAN:
            return text.replace(bare, GERMAN[bare])
        for pattern, german in self._patterns:
            if found := pattern.fullmatch(bare):
                return text.replace(bare, german.format(*map(self.comma, found.groups())))
        return text

    @cached_property
    def _patterns(self) -> list[tuple[re.Pattern[str], str]]:
        found = [(key, text) for key, text in GERMAN.items() if "{}" in key]
        return [(re.compile(re.escape(key).replace(r"\{\}", "(.+?)")), text) for key, text in found]

    def number(self, value: float | None, digits: int = 4) -> str:
        """A number in this language, empty for None."""
        return "" if value is None else self.comma(plain(value, digits).replace(",", "").replace("-", "−"))

    def comma(self, text: str) -> str:
        """With a decimal comma where the language has one."""
        return re.sub(r"(?<=\d)\.(?=\d)", ",", text) if self.language == "de" else text
