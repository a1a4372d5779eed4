"""From a study to something that runs: a page, an archive for JATOS, files for PsychoPy.

Of the other rooms it imports `answers`: a study's folder is described as the data set that its answers will be.
"""
