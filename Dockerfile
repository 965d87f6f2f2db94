# Image that contains only the files of the release. Its build context is the unpacked archive.
FROM scratch
COPY . /usr
WORKDIR /work
ENTRYPOINT ["/usr/bin/stochc"]
