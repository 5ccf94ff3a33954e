"""The data sheet of a spring as a document: drawing, tables and diagrams on A4, in two languages."""
