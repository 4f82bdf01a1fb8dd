# Palpable in a container: the packages of tools/package.sh, which comes first. The live loop on the synthetic
# desk, without camera and GPU; pictures, film and touches go to /out.
#
#   tools/package.sh
#   docker build -t palpable .
#   docker run --rm -v "$PWD/out:/out" palpable
#
# The image holds palpable-bake, too (AGPL-3, docs/licences.md); whoever hands it on without leaves that file out.
FROM debian:12-slim
COPY build/packages/*.deb /packages/
RUN apt-get update \
    && apt-get install -y --no-install-recommends /packages/*.deb \
    && rm -rf /packages /var/lib/apt/lists/*
WORKDIR /out
CMD ["palpable", "live", "/usr/share/palpable/bodies/post.palpable", "--source", "synthetic", "--out", "/out", "--write", "+stills", "--overwrite"]
