"""How an author's problems become a release; the students' labkit comes without this folder."""
