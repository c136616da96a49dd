# costeer's command line, installed from the hashed lock.
#   docker build -t costeer .
#   docker run --rm -v "$PWD/out:/data/out" costeer study --out out/study
FROM python:3.12-slim-bookworm

RUN useradd --create-home costeer && mkdir /data && chown costeer /data
WORKDIR /source
COPY requirements requirements
RUN pip install --no-cache-dir --require-hashes -r requirements/base.lock
COPY . .
RUN pip install --no-cache-dir --no-deps --no-build-isolation . && rm -rf /source/*

USER costeer
WORKDIR /data
ENTRYPOINT ["costeer"]
CMD ["--help"]
