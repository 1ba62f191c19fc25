# Two images.  The student's, which JupyterHub can start, contains labkit and the notebooks, no answers:
#   docker build -t baxter-lab .
#   docker run --rm -p 8888:8888 baxter-lab                          Jupyter, with a token
# The image of the whole course is for instructors and graders; the dev container has its system's packages alone:
#   docker build --target course -t baxter-course .
#   docker run --rm OPTIONS baxter-course make demo                  everything, isolation included
# Grading makes sandboxes, which Docker forbids by default. OPTIONS, for a container that does nothing else:
#   --security-opt=seccomp=unconfined --security-opt=apparmor=unconfined
#   --security-opt=systempaths=unconfined --cap-add=SYS_ADMIN --cap-add=NET_ADMIN
# Inside the container, `labkit doctor` says whether these rights suffice. Our gate has no Docker: it
# tests the sandbox with these rights, but not the images.
FROM python:3.11-slim-bookworm AS python
RUN apt-get update && apt-get install -y --no-install-recommends libgomp1 git \
    && rm -rf /var/lib/apt/lists/*

FROM python AS tools
RUN apt-get update && apt-get install -y --no-install-recommends \
      make bubblewrap libseccomp2 chromium nodejs libatomic1 && rm -rf /var/lib/apt/lists/*

FROM tools AS course
WORKDIR /lab
COPY . .
RUN make .venv/.course && .venv/bin/labkit student-zip && .venv/bin/python -m zipfile -e dist/baxter-lab.zip /handout
ENV PATH="/lab/.venv/bin:$PATH"
EXPOSE 8888
CMD ["jupyter", "lab", "--ip=0.0.0.0", "--no-browser", "--allow-root", "--notebook-dir=assignments"]

FROM python AS student
# The hub's own version: docker build --build-arg HUB=5.4.0
ARG HUB=6.1.1
COPY --from=course /handout/baxter-lab /lab/.ci/start_container.sh /opt/baxter-lab/
RUN pip install --quiet --no-cache-dir --disable-pip-version-check --root-user-action=ignore \
      --constraint /opt/baxter-lab/constraints.txt \
      jupyterlab "$(ls /opt/baxter-lab/labkit-*.whl)[notebook]" "jupyterhub==$HUB" nbgitpuller==1.3.0 nbgrader
# Of nbgrader's extensions, a student has only the list of assignments; a hub mounts its exchange in the
# folder made here. JupyterLab does not ask for news.
RUN for part in formgrader course_list validate_assignment; do \
      jupyter server extension disable --sys-prefix "nbgrader.server_extensions.$part"; done \
    && for part in jupyter/nbgrader:formgrader jupyter/nbgrader:create-assignment \
      jupyter/nbgrader:course-list jupyter/nbgrader:validate-assignment \
      jupyterlab/apputils-extension:announcements; do \
      jupyter labextension disable --level=system "@$part"; done \
    && mkdir -m 777 -p /usr/local/share/nbgrader/exchange
# The user and the home folder that hubs expect; start_container.sh also fills a volume mounted there.
RUN useradd --create-home --uid 1000 jovyan
USER jovyan
WORKDIR /home/jovyan
EXPOSE 8888
ENTRYPOINT ["sh", "/opt/baxter-lab/start_container.sh"]
CMD ["lab"]
