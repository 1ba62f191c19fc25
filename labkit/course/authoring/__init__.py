"""Making a release from an author's problems; the students' labkit comes without this folder."""
