// Answers as a table that can be taken home, after RFC 4180.

const LINE_END = "\r\n";
const NUMBER = /^-?\d/;

/** A cell: quoted where it must be, and where a spreadsheet would take it for a formula. */
export function cellOf(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "";
  if (typeof value === "number") return String(value);
  const isPlain = !/[",\r\n]/.test(value) && !/^[=+\-@\t ]|\s$/.test(value);
  return isPlain || (NUMBER.test(value) && !/[",\r\n]/.test(value)) ? value : `"${value.replaceAll('"', '""')}"`;
}

export function csvTable(rows, columns) {
  const lines = [columns, ...rows.map((row) => columns.map((name) => row[name]))];
  return lines.map((line) => line.map(cellOf).join(",") + LINE_END).join("");
}

/** Hand a text to the participant as a file. */
export function saveFile(text, name) {
  const blob = new Blob([text], { type: "text/csv;charset=utf-8" });
  const anchor = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
  anchor.click();
  setTimeout(() => URL.revokeObjectURL(anchor.href), 10_000);
}
