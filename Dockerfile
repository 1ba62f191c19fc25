# One image for a JupyterHub user, for trying the course, and for grading:
#   docker build -t baxter-lab .
#   docker run --rm -p 8888:8888 baxter-lab                          a student's Jupyter, with a token
#   docker run --rm OPTIONS baxter-lab make demo                     everything, isolation included
# Grading makes sandboxes, which Docker forbids unasked. OPTIONS, for a container that does nothing else:
#   --security-opt=seccomp=unconfined --security-opt=apparmor=unconfined
#   --security-opt=systempaths=unconfined --cap-add=SYS_ADMIN --cap-add=NET_ADMIN
# `labkit doctor` says inside whether that suffices. Our gate, which has no Docker, tries the sandbox
# with these rights, but not the image.
FROM python:3.11-slim-bookworm
RUN apt-get update && apt-get install -y --no-install-recommends \
      make git libgomp1 bubblewrap chromium nodejs npm && rm -rf /var/lib/apt/lists/*
WORKDIR /lab
COPY . .
RUN make .venv/.course
ENV PATH="/lab/.venv/bin:$PATH"
EXPOSE 8888
CMD ["jupyter", "lab", "--ip=0.0.0.0", "--no-browser", "--allow-root", "--notebook-dir=assignments"]
