# An image with the command `ltlc`, for CI: `docker build -t ltlc .`, then
# `docker run --rm -v "$PWD:/work" ltlc ltlc check props.txt`. The C compiler runs the C that ltlc emits before it is written.
FROM python:3.12-slim
RUN apt-get update \
    && apt-get install -y --no-install-recommends gcc libc6-dev \
    && rm -rf /var/lib/apt/lists/*
COPY pyproject.toml hatch_build.py README.md LICENSE EXCEPTION.md /source/
COPY ltlc /source/ltlc
RUN pip install --no-cache-dir '/source[recordings]' && rm -rf /source
WORKDIR /work
CMD ["ltlc", "--help"]
